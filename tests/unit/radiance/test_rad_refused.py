"""Errors in a scene file are reported with their line, and nothing is skipped."""

import pytest

from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad

GREY = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
FLOOR = "grey polygon floor 0 0 9 0 0 0 1 0 0 1 1 0\n"

CASES = {
    # What is not known
    "material": ("void brass x 0 0 0", 2, 'unknown type "brass"'),
    "unsupported": ("void mist x 0 0 0", 2, 'mist "x": unsupported type'),
    "pattern": ("void brightfunc x 2 a b 0 0", 2, 'the file "b" is missing'),
    "surface": ("grey instance x 1 a.oct 0 0", 2, 'instance "x": the file "a.oct"'),
    "modifier": ("wood sphere x 0 0 4 0 0 0 1", 2, 'undefined modifier "wood"'),
    "inherit": ("inherit plastic x 0 0 5 0 0 0 0 0", 2, 'undefined modifier "inherit"'),
    "late": ("\n\nlate sphere x 0 0 4 0 0 0 1", 4, 'undefined modifier "late"'),
    "two materials": (
        "grey plastic x 0 0 5 0 0 0 0 0",
        2,
        'modifier of plastic "x" is the',
    ),
    "alias": ("void alias x brick", 2, 'undefined modifier "brick"'),
    "alias of void": ("inherit alias x void", 2, "refers to void"),
    "alias chain": ("grey alias x grey", 2, 'is the material "grey"'),
    # Counts and numbers
    "vertices": ("grey polygon x 0 0 10 1 2 3 4 5 6 7 8 9 10", 2, "10 numbers"),
    "too few": ("grey polygon x 0 0 6 1 2 3 4 5 6", 2, "at least 3 vertices"),
    "negative": ("grey polygon x 0 0 -9 0 0 0", 2, '"-9" is found where the count'),
    "plastic": ("void plastic x 0 0 4 1 1 1 0", 2, "4 numbers; 5 expected"),
    "glass": ("void glass x 0 0 2 1 1", 2, "2 numbers; 3 or 4 expected"),
    "strings": ("void glow x 1 a 0 4 1 1 1 0", 2, "1 string arguments; none"),
    "integers": ("void glow x 0 1 7 4 1 1 1 0", 2, "has integer arguments"),
    "sphere": ("grey sphere x 0 0 3 0 0 0", 2, "3 numbers; 4 expected"),
    "cone": ("grey cone x 0 0 7 0 0 0 0 0 1 1", 2, "7 numbers; 8 expected"),
    "word": ("grey sphere x 0 0 4 0 0\n0 one", 3, '"one" where number 4 of 4'),
    "nan": ("grey polygon x 0 0 9 0 0 0\n1 0 0 1 1 nan", 3, '"nan" where number 9'),
    "infinite": ("grey polygon x 0 0 9 0 0 0 1 0 0 1 1 inf", 2, '"inf" where number 9'),
    "overflow": ("grey polygon x 0 0 9 0 0 0 1 0 0 1 1 1e400", 2, "exceeds 1e+15"),
    "huge": ("grey sphere x 0 0 4 0 0 0 1e200", 2, "exceeds 1e+15"),
    "too many": (FLOOR + "3 3 3\n" + FLOOR, 3, "more numbers than its count"),
    "swallowed": (
        "grey polygon x 0 0 12 0 0 0 1 0 0 1 1 0\n" + FLOOR,
        3,
        '"grey" where',
    ),
    # Values
    "reflectance": ("void plastic x 0 0 5 -.1 0 0 0 0", 2, "reflectance is -0.1"),
    "specularity": ("void plastic x 0 0 5 0 0 0 1.1 0", 2, "specularity is 1.1"),
    "roughness": ("void plastic x 0 0 5 0 0 0 0 -.1", 2, "roughness is -0.1"),
    "index": ("void glass x 0 0 4 1 1 1 0.9", 2, "index of refraction is 0.9"),
    "radiance": ("void light x 0 0 3 1 -1 1", 2, "radiance is -1"),
    "radius": ("grey tube x 0 0 7 0 0 0 0 0 1 0", 2, "radius is 0; a positive"),
    "radii": ("grey cone x 0 0 8 0 0 0 0 0 1 1 -1", 2, "radius is 1, -1"),
    "ring": ("grey ring x 0 0 8 0 0 0 0 0 1 1 1", 2, "radii are 1 and 1"),
    "normal": ("grey ring x 0 0 8 0 0 0 0 0 0 0 1", 2, "direction is zero"),
    "angle": ("grey source x 0 0 4 0 0 1 0", 2, "angle is 0°"),
    "dark source": ("grey source x 0 0 4 0 0 1 5", 2, "a glow or a light expected"),
    # Truncated
    "no type": ("grey", 2, "the file ends where the type"),
    "no name": ("grey polygon", 2, "the file ends where the name"),
    "no count": ("grey polygon x 0 0", 2, "the file ends where the count of numbers"),
    "no numbers": (
        "grey polygon x 0 0 9\n1.00 2.00 3.00",
        3,
        "the file ends where number 4 of 9",
    ),
    "vast count": (
        "grey polygon x 0 0 99999999999",
        2,
        "the file ends before its 99999999999",
    ),
    "quote": ("grey polygon 'x 0 0 9", 2, "quotation mark is not closed"),
    # Commands
    "command": (
        "!genclock -t 12",
        2,
        '"genclock" in the command "genclock -t 12"',
    ),
    "piped": ("!xform part.rad | sort", 2, '"sort" in the command'),
    "shell": ("!xform part.rad; rm part.rad", 2, '";" in the command'),
    "quotes": ("!xform 'part.rad", 2, "cannot be read"),
    "nothing": ("!", 2, "a command is empty"),
    "no file": ("!xform -t 1 2 3", 2, "has no file"),
    "missing": (
        "\n!xform absent.rad",
        3,
        'the file "absent.rad" is missing; searched in',
    ),
    "option": ("!xform -q part.rad", 2, 'option "-q" is unknown'),
    "order": (
        "!xform -t 1 2 3 -m grey part.rad",
        2,
        'option "-m" is unknown or out of order',
    ),
    "array": ("!xform -a 0 -t 1 1 1 part.rad", 2, 'xform -a is followed by "0"'),
    "vast array": (
        "!xform -a 9999999 -t 0 0 1 part.rad",
        2,
        "more than 100000 copies",
    ),
    "zero": ("!xform -s 0 part.rad", 2, "other than 0"),
    "lists": ("!xform -f absent part.rad", 2, 'the file "absent" is missing'),
    "no list": ("!xform -f", 2, "xform -f has no file"),
    "name": ("!xform -m", 2, "xform -m has no value"),
    "itself": ("!xform main.rad", 2, "includes itself: main.rad → main.rad"),
}


@pytest.mark.parametrize("case", CASES, ids=str)
def test_what_is_wrong_is_reported_with_its_place(tmp_path, case):
    text, line, message = CASES[case]
    (tmp_path / "part.rad").write_text(FLOOR)
    file = tmp_path / "main.rad"
    file.write_text(GREY + text)
    with pytest.raises(InputError) as caught:
        read_rad(file)
    assert str(caught.value).startswith(f"{file}:{line}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_fault_in_an_included_file_is_reported_with_its_own_place(tmp_path):
    (tmp_path / "part.rad").write_text("\n\nwood sphere x 0 0 4 0 0 0 1")
    (tmp_path / "main.rad").write_text("!xform part.rad")
    with pytest.raises(InputError, match=r"part\.rad:3: undefined modifier"):
        read_rad(tmp_path / "main.rad")


def test_files_that_include_each_other_are_refused(tmp_path):
    (tmp_path / "a.rad").write_text("!xform b.rad")
    (tmp_path / "b.rad").write_text("!cat ./a.rad")
    with pytest.raises(InputError, match=r"b\.rad:1: .*a\.rad → b\.rad → a\.rad"):
        read_rad(tmp_path / "a.rad")


@pytest.mark.parametrize("name", ["absent.rad", "."])
def test_what_is_no_file_is_refused(tmp_path, name):
    with pytest.raises(InputError, match="cannot be read"):
        read_rad(tmp_path / name)
