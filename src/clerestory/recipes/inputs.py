"""Inputs of recipes: declared names, types and defaults, and values from a JSON file.

Names, types and defaults are those of the public interfaces of Ladybug Tools' recipes,
so that the same file of inputs is valid for both.
"""

import json
import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
from jaxtyping import Bool, Float

from clerestory.checks import one_of, require, within
from clerestory.documents import json_value
from clerestory.errors import InputError, located
from clerestory.files import is_file, read_text

Kind = Literal["file", "text", "number", "whole number"]

# Other names of inputs, in components of Grasshopper
_ALIASES = {
    "radiance-par": "radiance-parameters",
    "min-sen-count": "min-sensor-count",
    "wea": "epw",
}

# Paths for each ray of -ad: coefficients of a sensor have then about the noise of
# Radiance, which has one ray in each cell of the hemisphere and splits them at surfaces
PATHS = 4

# Options of Radiance's tracing programs that are accepted in "radiance-parameters"
_RADIANCE = re.compile(
    r"-(a[abdrsv]|bv|c|d[cjprstv]|i|I|l[rw]|m[sgae]|p[adjst]|s[st]|st|u|w)[+-]?"
)


@final
@dataclass(frozen=True)
class Input:
    """One input of a recipe; `default` is None for inputs that may be missing.

    `limits` are the least and greatest number, `choices` the valid texts.
    """

    name: str
    kind: Kind
    default: Any = None
    required: bool = False
    limits: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    def checked(self, value: object) -> Any:
        """Return a value of the input, which must have the right type."""
        what = f'input "{self.name}"'
        expected = {"file": "the name of a file", "text": "text"}.get(self.kind)
        message = f"{what} is {json.dumps(value)[:60]}; {expected or 'a ' + self.kind}"
        if self.kind in ("file", "text"):
            require(isinstance(value, str), f"{message} expected")
            if self.choices:
                one_of(value, what, choices=self.choices)
            return value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{message} expected")
        whole = self.kind == "whole number"
        require(not whole or value == round(value), f"{message} expected")
        if self.limits:
            within(value, what, least=self.limits[0], most=self.limits[1])
        return int(value) if whole else value


def read_inputs(path: str | Path, declared: Sequence[Input]) -> dict[str, Any]:
    """Return the values of the inputs of a recipe from a JSON file, with defaults.

    Words of names may be separated by hyphens or underscores. Relative names of files
    refer to the current folder or, if there is no such file, to that of the JSON file.

    Raises
    ------
    InputError : an input is unknown, missing, of the wrong type or out of range, or its
        file does not exist
    """
    path = Path(path)
    known = {each.name: each for each in declared}
    with located(file=path):
        given = json_value(read_text(path), file=path)
        require(isinstance(given, dict), "the file is not a JSON object; { } expected")
        values: dict[str, Any] = {each.name: each.default for each in declared}
        for key, value in given.items():
            name = key.replace("_", "-")
            name = name if name in known else _ALIASES.get(name, name)
            one_of(name, "input", choices=known)
            if value is not None:
                values[name] = known[name].checked(value)
        for each in declared:
            present = values[each.name] not in (None, "")
            require(present or not each.required, f'input "{each.name}" is missing')
            if each.kind == "file":
                values[each.name] = _file(each.name, values[each.name], path.parent)
    return values


def _file(name: str, value: str | None, folder: Path) -> Path | None:
    if not value:
        return None
    found = [each for each in (Path(value), folder / value) if is_file(each)]
    require(found, f'input "{name}" is {value!r}; a file that exists expected')
    return found[0]


def traced_effort(parameters: str, *, per_ray: int = PATHS) -> dict[str, int]:
    """Return samples and bounces for Radiance's ambient options.

    -ab is the number of bounces; each ray of -ad (times -c) stands for `per_ray` paths.
    The other options of rtrace and rfluxmtx control interpolation and Russian roulette,
    and have no effect.

    >>> traced_effort("-ab 2 -ad 5000 -lw 2e-05 -dr 0")
    {'samples': 20000, 'bounces': 2}
    """
    found = {"-ab": 2.0, "-ad": 5000.0, "-c": 1.0}
    last = ""
    for word in shlex.split(parameters):
        if _RADIANCE.fullmatch(word):
            last = word
            continue
        what = f"radiance-parameters are {parameters!r}"
        try:
            number = float(word)
        except ValueError:
            number = float("nan")
        valid = last and np.isfinite(number) and number >= 0
        message = (
            f"{what}: {word!r} is unknown; options of rtrace and rfluxmtx expected"
        )
        require(valid, message)
        found[last] = number
    within(found["-ab"], "-ab", least=1, most=1000)
    within(found["-ad"] * found["-c"], "-ad times -c", least=1, most=1 << 26)
    samples = per_ray * int(found["-ad"] * found["-c"])
    return {"samples": samples, "bounces": int(found["-ab"])}


def thresholds(text: str) -> Mapping[str, float]:
    """Return the illuminances -t, -lt and -ut of daylight autonomy and UDI [lux].

    >>> thresholds("-ut 2000")["-ut"], thresholds("-ut 2000")["-t"]
    (2000.0, 300.0)
    """
    found = {"-t": 300.0, "-lt": 100.0, "-ut": 3000.0}
    words = text.split()
    message = f"thresholds are {text!r}; -t, -lt and -ut with numbers expected"
    require(len(words) % 2 == 0, message)
    for key, word in zip(words[::2], words[1::2], strict=True):
        require(key in found and word.replace(".", "", 1).isdigit(), message)
        found[key] = float(word)
    ordered = found["-lt"] < found["-ut"] and found["-t"] > 0
    require(ordered, f"thresholds are {text!r}; -lt below -ut, and -t above 0 expected")
    return found


def occupied_steps(
    schedule: Path | None, hours: Float[np.ndarray, " step"]
) -> Bool[np.ndarray, " step"]:
    """Return which time steps are occupied; `hours` are hours of the year.

    A schedule file has 8760 values, one a line; hours with 0.1 or more are occupied.
    Without a schedule the hours from 8 to 18 of every day are occupied, as the
    postprocessing package of Ladybug Tools assumes.
    """
    if schedule is None:
        return np.asarray((hours % 24 >= 8) & (hours % 24 < 18))
    with located(file=schedule):
        words = read_text(schedule).replace(",", " ").split()
        message = f"{len(words)} values; 8760, one for each hour, expected"
        require(len(words) == 8760, message)
        try:
            values = np.array([float(word) for word in words])
        except ValueError:
            require(False, "a value is not a number; numbers from 0 to 1 expected")
        found = values[hours.astype(int)] >= 0.1
        require(
            found.any(), "no time step is occupied; a value of 0.1 or more expected"
        )
        return np.asarray(found)
