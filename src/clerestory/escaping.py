r"""Names and texts in files that other programs read.

Names come from files of unknown origin, and other programs interpret what they read:
Radiance runs a line that begins with `!`, a shell expands `$(…)`, a spreadsheet
evaluates a cell that begins with `=`. Special characters are written as `=` and
two hexadecimal digits, as in quoted-printable text (RFC 2045), or quoted where a format
has quotation marks. Different names remain different, and plain names are unchanged.
"""

import csv
import hashlib
import io
import json
import re
import unicodedata
from collections.abc import Container, Iterable, Sequence

from clerestory.errors import InputError

# Longest name that is written in full [bytes]: rfluxmtx reads names of 127 bytes; file
# names, with the suffixes that programs add, have up to 255
_LONGEST_NAME = 100

# Longest line of a comment or header: Radiance reads pieces of 512 or 2048 bytes
_LONGEST_LINE, _LONGEST_WORD = 480, 511

# Special characters of Radiance or of a shell, and of file names
_COMMANDS = frozenset(" \"'`$;&|<>()*?!\\")
_PATHS = frozenset('/\\:*?"<>|`$;&%!')

# Reserved names: in Radiance, and of files on Windows
_RESERVED_NAMES = {"", "void", "inherit"}
_DEVICES = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?")

# First characters of cells that spreadsheets evaluate (an apostrophe prevents it);
# numbers; texts that could be read as escapes; characters that XML does not allow
_FORMULA = tuple("'=+-@\uff1d\uff0b\uff0d\uff20'")
_NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?|[-+]?(nan|inf)", re.ASCII)
_AMBIGUOUS = re.compile(r"=(?=[0-9A-F]{2}|$)")
_NOT_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def radiance_name(name: str) -> str:
    r"""Return a name of a material or surface as it is written to a scene file.

    Blanks and characters other than ASCII are escaped too: rfluxmtx reads no quotation
    marks, and rcontrib no other characters.

    >>> radiance_name("wall#2"), radiance_name('a"\n!touch x')
    ('wall#2', 'a=22=0A=21touch=20x')
    """
    if name in _RESERVED_NAMES:
        return f"{name}="
    return _shortened(_encoded(name, _COMMANDS, first="#-~@", ascii_only=True), name)


def mgf_name(name: str) -> str:
    """Return a name as a word of MGF: ASCII characters that begin with a letter.

    >>> mgf_name("wall"), mgf_name("2 é")
    ('wall', 'x_2=20=C3=A9')
    """
    word = radiance_name(name)
    return word if word[0].isalpha() else f"x_{word}"


def radiance_word(word: str) -> str:
    """Return a word of a scene file, in quotation marks if it contains blanks.

    Raises
    ------
    InputError : the text cannot be quoted as one word, such as a path with line breaks
    """
    quotes = [quote for quote in "\"'" if quote not in word]
    plain = word.isprintable() and len(word.encode(errors="replace")) <= _LONGEST_WORD
    if not plain or not word or word[0] in "\"'!#" or (" " in word and not quotes):
        raise InputError(
            f"a word of a scene file is {word!r}; at most {_LONGEST_WORD} printable"
            " characters that do not begin with a quotation mark, ! or # expected"
        )
    return f"{quotes[0]}{word}{quotes[0]}" if " " in word else word


def header_line(text: str, *, longest: int = _LONGEST_LINE) -> str:
    r"""Return a text as one line of a comment or header, of at most `longest` bytes.

    >>> header_line("blind\n!touch x")
    'blind !touch x'
    """
    return _cut("".join(c if c.isprintable() else " " for c in text).strip(), longest)


def file_stem(name: str) -> str:
    r"""Return a name as a part of a file name, valid in every operating system.

    >>> file_stem("desks"), file_stem("../../a"), file_stem("CON")
    ('desks', '=2E.=2F..=2Fa', '=43ON')
    """
    if not name:
        return "="
    if _DEVICES.fullmatch(name):
        return f"={ord(name[0]):02X}{name[1:]}"
    return _shortened(_encoded(name, _PATHS, first=".-~ ", last=". "), name)


def file_stems(
    names: Iterable[str], *, taken: Container[str] = (), blank: str = " "
) -> dict[str, str]:
    """Return a stem of a file name for each name; no two differ in case only.

    `taken` are other stems in the folder, in lower case; `blank` replaces blanks.

    >>> file_stems(["south", "South", "scene"], taken={"scene"})
    {'south': 'south', 'South': 'South~0dd2dae4', 'scene': 'scene~4f48f720'}
    """
    found: dict[str, str] = {}
    used: set[str] = set()
    for name in dict.fromkeys(names):
        stem = file_stem(name).replace(" ", blank)
        if _folded(stem) in used or _folded(stem) in taken:
            stem = f"{stem}~{_digest(name)[:8]}"
        used.add(_folded(stem))
        found[name] = stem
    return found


def printable(text: str) -> str:
    r"""Return a text with backslash escapes for characters that cannot be printed.

    >>> printable("a\nb")
    'a\\nb'
    """
    if text.isprintable() and "\\" not in text:
        return text
    return "".join(c if c in "'\"" else repr(c)[1:-1] for c in text)


def terminal_text(text: str) -> str:
    r"""Return a text without control sequences of terminals; lines and tabs remain.

    >>> terminal_text("a\x1b[2J\n")
    'a\\x1b[2J\n'
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in "\n\t\xa0" else repr(c)[1:-1] for c in text
    )


def figure_text(text: str) -> str:
    r"""Return a text that Matplotlib shows as it is, of at most 100 characters.

    >>> figure_text("$x$")
    '\\$x\\$'
    """
    # Legends omit labels that are empty or begin with an underscore
    shown = f"\N{NO-BREAK SPACE}{text}" if text[:1] in ("", "_") else text
    cut = shown if len(shown) <= _LONGEST_NAME else f"{shown[:_LONGEST_NAME]}…"
    return terminal_text(cut).replace("$", r"\$")


def toml_value(value: str | float | Sequence[str | float]) -> str:
    r"""Return a text, number or list as a TOML value.

    >>> toml_value('a"\n'), toml_value(["b", 1.5])
    ('"a\\"\\n"', '["b", 1.5]')
    """
    text = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return text.encode(errors="replace").decode()


def xml_text(text: str) -> str:
    r"""Return a text without the characters that XML cannot represent.

    >>> xml_text("a\x00b")
    'a=00b'
    """
    return _NOT_XML.sub(lambda found: _hexadecimal(found[0]), text)


def table_cell(text: str) -> str:
    r"""Return the text of a spreadsheet cell; an apostrophe precedes formulas.

    Characters that cannot be printed become backslash escapes.

    >>> table_cell("=1+1"), table_cell("desk"), table_cell("a\nb")
    ("'=1+1", 'desk', 'a\\nb')
    """
    text = printable(text)
    formula = text.startswith(_FORMULA) and not _NUMBER.fullmatch(text)
    return f"'{text}" if formula else text


def plain_cell(cell: str) -> str:
    """Return the text of a cell that `table_cell` has made."""
    return cell[1:] if cell.startswith("'") and cell[1:2] in _FORMULA else cell


def csv_line(cells: Sequence[str]) -> str:
    r"""Return texts as a line of a CSV file, without line feed.

    >>> csv_line(["=1+1", "a,b"])
    '\'=1+1,"a,b"'
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(map(table_cell, cells))
    return text.getvalue()


def _encoded(
    name: str,
    special: Container[str],
    *,
    first: str,
    last: str = "",
    ascii_only: bool = False,
) -> str:
    # Escape characters that are special anywhere, or at the beginning or end of a name
    end = len(name) - 1
    return "".join(
        _hexadecimal(c)
        if not c.isprintable()
        or c in special
        or (ascii_only and not c.isascii())
        or (i == 0 and c in first)
        or (i == end and c in last)
        or (c == "=" and _AMBIGUOUS.match(name, i))
        else c
        for i, c in enumerate(name)
    )


def _hexadecimal(text: str) -> str:
    return "".join(f"={byte:02X}" for byte in text.encode(errors="surrogatepass"))


def _shortened(encoded: str, name: str) -> str:
    # A digest replaces the end of a long name; names written in full are shorter
    if len(encoded.encode()) <= _LONGEST_NAME:
        return encoded
    return f"{_cut(encoded, _LONGEST_NAME)}~{_digest(name)[:16]}"


def _cut(text: str, longest: int) -> str:
    return text.encode()[:longest].decode(errors="ignore")


def _digest(name: str) -> str:
    return hashlib.sha256(name.encode(errors="surrogatepass")).hexdigest()


def _folded(stem: str) -> str:
    return unicodedata.normalize("NFKC", stem).casefold()
