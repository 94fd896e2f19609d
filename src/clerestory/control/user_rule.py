"""A rule in a Python file of the user's: imported, as any module is, and called.

The file runs with all the rights of the program. It is named by whoever writes the
study, and nothing else is run.
"""

import importlib.util
from pathlib import Path

from clerestory.control.control_rule import Rule
from clerestory.errors import InputError


def load_rule(path: str | Path, name: str) -> Rule:
    r"""Return a function from a Python file.

    Raises
    ------
    InputError : the file cannot be run, or has no function of this name

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "rules.py")
    ...     _ = file.write_text("def closed(situation):\n    return 1")
    ...     rule = load_rule(file, "closed")
    >>> rule(None)
    1
    """
    path = Path(path)
    spec = importlib.util.spec_from_file_location(f"rules_of_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError("is not a Python file; one expected", file=path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever the user's file does
        raise InputError(f"{_told(error)}; a file that runs expected", file=path) from (
            error
        )
    found = getattr(module, name, None)
    if not callable(found):
        raise InputError(f'has no function "{name}"; one expected', file=path)
    return found  # type: ignore[no-any-return]


def _told(error: BaseException) -> str:
    text = " ".join(str(error).split())[:200]
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
