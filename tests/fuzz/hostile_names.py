"""Names as a hostile file gives them, and a check that none of them is obeyed."""

import random
from pathlib import Path

# Each name that is obeyed makes a file of this name in the current folder
CANARY = "canary"

NAMES = [
    *("plain", "north wall", "wall#2", "50%", "Nordraum", "Büro 3", "", " ", "void"),
    *(f'"\n!touch {CANARY}\n', f"'\n!touch {CANARY}\n", f"x\r!touch {CANARY}"),
    *(f'a" \n!touch {CANARY} \n"', f"!touch {CANARY}", f"#\n!touch {CANARY}"),
    *(f"a\n\n!touch {CANARY}", f"a\u2028!touch {CANARY}", f"a\x0b!touch {CANARY}"),
    *(f"a\0!touch {CANARY}", f"\t!touch {CANARY}", f"a;touch {CANARY};b"),
    *(f"$(touch {CANARY})", f"`touch {CANARY}`", f"a|touch${{IFS}}{CANARY}|b"),
    *(f"a'\"\n!touch {CANARY}", f"a&touch {CANARY}&b", f"<({CANARY})"),
    *("x" * 512, "x" * 5000, "x" * 505 + f"\n!touch {CANARY}"),
    *("x" * 511 + f" !touch {CANARY}", f"!touch {CANARY}\n" * 400),
    *("y" * 2040 + f"\n!touch {CANARY}", "\u00e9" * 300, "\U0001f3e0" * 200),
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


def require_silence(folder: Path) -> None:
    """Fail if a name was obeyed: a canary below the folder or where we are."""
    found = [*folder.rglob(f"{CANARY}*"), *Path().glob(f"{CANARY}*")]
    assert not found, f"a name was run as a command: {found}"
