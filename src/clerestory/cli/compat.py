"""`clerestory compat`: programs of Radiance with their own options."""

import shlex
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from clerestory.checks import one_of
from clerestory.cli.command import COMMAND_LINE
from clerestory.cli.program import program
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.compat import Compat
from clerestory.compat.programs import PROGRAMS, install_programs, run_program
from clerestory.compat.streams import Streams
from clerestory.compat.words import Grammar, Word
from clerestory.files import read_bytes

_EVALGLARE = "evalglare"
_NAMES = (*PROGRAMS, _EVALGLARE)

# Options of evalglare that have the same name and meaning in `clerestory glare`
_GLARE = {
    **dict.fromkeys(("-s", "-y", "-x", "-d", "-V"), 0),
    **dict.fromkeys(("-b", "-r", "-Y", "-G", "-i", "-C", "-A", "-B", "-c", "-P"), 1),
    **dict.fromkeys(("-t", "-T", "-I", "-u", "-l"), 3),
    "-L": 4,
    "-w": 8,
}
_BACKGROUND = {"0": "cie", "1": "average", "2": "illuminance"}
_VIEW = {"-vf": 1, "-vp": 3, "-vd": 3, "-vu": 3} | dict.fromkeys(
    ("-vh", "-vv", "-vs", "-vl", "-vo", "-va"), 1
)
_EVALGLARE_WORDS = Grammar(_EVALGLARE, {**_GLARE, **_VIEW, "-q": 1, "-v": 0}, ("-vt",))


def compat(request: Compat) -> None:
    """Write the scripts that stand for programs of Radiance."""
    scripts = install_programs(request.install, _NAMES)
    say(
        f"{len(scripts)} scripts in {request.install}; put it first in PATH:"
        f' export PATH="{request.install.resolve()}:$PATH"',
        quiet=request.quiet,
    )


def run_compat(name: str, words: Sequence[str]) -> int:
    """Run a program of Radiance; return the exit status."""
    one_of(name, "program", choices=_NAMES)
    COMMAND_LINE.set(shlex.join([name, *words]))
    if name == _EVALGLARE:
        return _evalglare(words)
    with progress_display(quiet=not sys.stderr.isatty()) as display:
        streams = Streams(command=COMMAND_LINE.get(), progress=display(name))
        run_program(name, words, streams)
    return 0


def _evalglare(words: Sequence[str]) -> int:
    # Run `clerestory glare` with the options of evalglare
    options, view, pictures = [], [], []
    for word in _EVALGLARE_WORDS.words(words):
        if not word.name:
            pictures.append(word.text)
        elif word.name in _VIEW or word.name == "-vt":
            view += _view_words(word)
        elif word.name == "-q":
            one_of(word.text, f"{_EVALGLARE} -q", choices=tuple(_BACKGROUND))
            options += ["--background", _BACKGROUND[word.text]]
        elif word.name == "-v":
            say(f"{_EVALGLARE} of clerestory")
        elif word.name == "-w":
            options += [part for each in word.arguments for part in ("-w", each)]
        else:
            options += [word.name, *word.arguments]
    if view:
        options += ["--view", " ".join(view)]
    with _picture(pictures) as files:
        call = ["glare", "--quiet", *options, *files]
        return int(
            program(call)(call, prog_name="clerestory", standalone_mode=False) or 0
        )


def _view_words(word: Word) -> list[str]:
    return [word.name + word.text] if word.joined else [word.name, *word.arguments]


@contextmanager
def _picture(given: list[str]) -> Iterator[list[str]]:
    # Pictures of a command line; without one, the standard input as a file
    if given:
        yield given
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "picture.hdr")
        path.write_bytes(read_bytes("/dev/stdin"))
        yield [str(path)]
