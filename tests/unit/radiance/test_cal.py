"""Function files: the language, its functions, and what bounds a run."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.radiance.cal import run
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import parse_definitions, parse_expression


def value(expression, definitions="", arguments=(), **inputs):
    """Values of one expression, and where they are valid."""
    rows = max([np.size(v) for v in inputs.values()], default=1)
    given = {n: np.broadcast_to(np.asarray(v, float), rows) for n, v in inputs.items()}
    program = Program(parse_definitions(definitions))
    computed = program.values(
        (parse_expression(expression),), {"S": np.ones(rows)} | given, tuple(arguments)
    )
    return computed.value[:, 0], computed.valid


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("1+2*3", 7),
        ("(1+2)*3", 9),
        ("8/4/2", 1),
        ("2-3-4", -5),
        ("2^3^2", 512),
        ("-2^2", 4),  # a sign binds first
        ("2^-1", 0.5),
        ("+.5e1 - -1", 6),
        ("1{ a {nested} note }+1", 2),
        ("if(1, 2, 3)", 2),
        ("if(0, 2, 3)", 3),
        ("if(-1, 1/0, 3)", 3),
        ("select(2, 5, 6, 7)", 6),
        ("select(0, 5, 6, 7)", 3),
        ("max(3, 9, 2) + min(3, 9, 2)", 11),
        ("floor(-1.5) + ceil(1.2)", 0),
        ("mod(-1, 3)", 2),
        ("tri(5, 2)", 1),
        ("bound(0, 7, 5)", 5),
        ("sqrt(16) + exp(0) + log10(100)", 7),
        ("atan2(1, 1)", np.pi / 4),
        ("Acos(1.5)", 0),
        ("and(1, 2) + or(-1, 3) + not(5)", 4),
        ("linterp(.25, 0, 8)", 2),
        ("erf(0) + erfc(0)", 1),
        ("PI/DEGREE", 180),
    ],
)
def test_expressions_have_the_values_of_the_manual(expression, expected):
    found, valid = value(expression)
    assert found == pytest.approx(expected)
    assert valid.all()


def test_functions_take_functions():
    text = "sq3(i) : select(i, 1, 4, 9); one(i) : 1; twice(f, x) = f(f(x));"
    assert value("dot(sq3, one)", text)[0] == 14
    assert value("cross(3, sq3, one)", text)[0] == 1 - 4
    assert value("twice(sq, 3)", text)[0] == 81


def test_recursion_ends_ray_by_ray():
    """Each ray goes as deep as it needs; none computes what lies beyond."""
    text = "fact(n) = if(n-1.5, n*fact(n-1), 1);"
    found, valid = value("fact(x)", text, x=[1, 2, 3, 6])
    assert found.tolist() == [1, 2, 6, 720]
    assert valid.all()


def test_later_definitions_hold():
    assert value("a", "a = 1; b = a; a = 2;")[0] == 2


def test_marks_of_context_belong_to_no_name():
    assert value("len`P. + far", "len`P. = 2; far` = 3;")[0] == 5


def test_real_arguments_are_numbered():
    assert value("A1 + arg(2) + 10*AC + arg(0)", arguments=(3, 4))[0] == 3 + 4 + 22


def test_rays_without_a_value_are_reported():
    found, valid = value("1/x + sqrt(x)", x=[4, 0, -1])
    assert found[0] == 2.25
    assert valid.tolist() == [True, False, False]


def test_names_are_followed_to_what_is_missing():
    program = Program(parse_definitions("a = b*Dx; b = c(1); c(x) = x + N(1) + far;"))
    assert program.uses(parse_expression("a")) == {"Dx", "Nx", "Ny", "Nz", "far"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = 1 2;", '; ";" expected'),
        ("a : ;", "; a value expected"),
        ("a = (1;", '; ")" expected'),
        ("= 1;", "; a name expected"),
        ("f(x = 1;", '; ")" expected'),
        ("f(1) = 1;", "name of a parameter"),
        ("a = { x", "comment is not closed"),
        ("a = 1 % 2;", 'unexpected character "%"'),
        ("a = " + "(" * 100 + "1" + ")" * 100 + ";", "nested too deep"),
    ],
)
def test_broken_files_are_refused_with_their_line(text, message):
    with pytest.raises(InputError, match=r"^f.cal:2: .*") as caught:
        parse_definitions("ok = 1;\n" + text, file="f.cal")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("expression", "text", "message"),
    [
        ("a", "a = a + 1;", "a recursion that terminates"),
        ("f(1)", "f(x) = f(x+1);", "a recursion that terminates"),
        ("nothing", "", '"nothing" is not defined'),
        ("nothing(1)", "", '"nothing" is not defined'),
        ("f", "f(x) = x;", "needs arguments; f(…) expected"),
        ("f(1)", "f(x, y) = x;", "1 argument(s)"),
        ("a(1)", "a = 2;", "argument(s)"),
        ("if(1)", "", "3 expected"),
        ("A2", "", "real argument 2 is used, but the primitive has 0"),
        ("arg(3)", "", "real argument 3 is used, but the primitive has 0"),
        ("f(1+1)", "f(g) = g(1);", "its argument is an expression"),
    ],
)
def test_runs_without_an_end_or_a_meaning_are_refused(expression, text, message):
    with pytest.raises(InputError) as caught:
        value(expression, text)
    assert message in str(caught.value)


def test_long_runs_are_broken_off(monkeypatch):
    """Two calls in each of twenty levels are a million steps."""
    monkeypatch.setattr(run.Run, "most_steps", 1000)
    with pytest.raises(InputError, match="more than 1000 evaluation steps or"):
        value("f(20)", "f(n) = if(n, f(n-1) + f(n-1), 1);")


WORDS = "a f x 1 .5 2e3 ( ) ( ) , ; = : + - * / ^ if select A1 arg { } ` $1 é"
PIECES = st.sampled_from(WORDS.split(" "))


@settings(max_examples=200, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(PIECES, max_size=40).map(" ".join))
def test_any_text_is_read_or_refused(text):
    """Whatever stands in a file, it ends, in a value or in one line."""
    try:
        program = Program(parse_definitions(text, file="f.cal"))
        for definition in program.definitions.values():
            if definition.parameters is None:
                program.values((definition.body,), {"S": np.ones(2)}, (1.0,))
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
