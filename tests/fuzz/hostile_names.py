"""Names that contain commands, and a check that no command was executed."""

import random
from pathlib import Path

# An executed command makes a file of this name in the current folder
MARKER = "marker"

NAMES = [
    *("plain", "north wall", "wall#2", "50%", "Nordraum", "Büro 3", "", " ", "void"),
    *(f'"\n!touch {MARKER}\n', f"'\n!touch {MARKER}\n", f"x\r!touch {MARKER}"),
    *(f'a" \n!touch {MARKER} \n"', f"!touch {MARKER}", f"#\n!touch {MARKER}"),
    *(f"a\n\n!touch {MARKER}", f"a\u2028!touch {MARKER}", f"a\x0b!touch {MARKER}"),
    *(f"a\0!touch {MARKER}", f"\t!touch {MARKER}", f"a;touch {MARKER};b"),
    *(f"$(touch {MARKER})", f"`touch {MARKER}`", f"a|touch${{IFS}}{MARKER}|b"),
    *(f"a'\"\n!touch {MARKER}", f"a&touch {MARKER}&b", f"<({MARKER})"),
    *("x" * 512, "x" * 5000, "x" * 505 + f"\n!touch {MARKER}"),
    *("x" * 511 + f" !touch {MARKER}", f"!touch {MARKER}\n" * 400),
    *("y" * 2040 + f"\n!touch {MARKER}", "\u00e9" * 300, "\U0001f3e0" * 200),
    *("../../escape", "/etc/escape", "..", ".", "-rf", "--help", "~root", "a/b", "a:b"),
    *("CON", "nul.txt", "desk", "Desk", "DESK", "desk ", "desk.", "a b", "a_b"),
    *("=1+1", "=cmd|'/C calc'!A0", "+1+1", "-1+1", "@SUM(A1)", "'=1", "\t=1+1"),
    *("]]>", "<!--", "--", "-->", "</script><script>alert(1)</script>", "{{7*7}}"),
    *("\u202egnp.exe", "\u200f", "\ud800", "\udcff", "a\x7fb", "%n%s%d", "%03d"),
    *("a,b", "a\\nb", "NCOLS=99", "EXPOSURE=5", "FORMAT=ascii", "VIEW= -vtv"),
    *("a=0A", "a=", "a=3D", "[[x]]", "# x", "[window]", "a\ninherit"),
]


def more_names(count: int, seed: int = 1) -> list[str]:
    """Names of random pieces of the others."""
    rng = random.Random(seed)
    found = []
    for _ in range(count):
        parts = [rng.choice(NAMES) for _ in range(3)]
        found.append("".join(p[: rng.randrange(1, 60)] for p in parts))
    return found


def require_no_marker(folder: Path) -> None:
    """Fail if a command in a name made the marker file, in or below the folder."""
    found = [*folder.rglob(f"{MARKER}*"), *Path().glob(f"{MARKER}*")]
    assert not found, f"a name was run as a command: {found}"
