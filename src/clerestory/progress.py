"""Progress callbacks of long computations."""

from collections.abc import Callable

# Callback with the completed fraction, 0…1, and a note such as the ray rate
Progress = Callable[[float, str], None]


def silent(_title: str) -> Progress:
    """Return a progress callback that displays nothing, whatever the title."""
    return lambda _share, _note: None


def share_of_progress(
    progress: Progress | None, start: float, share: float, name: str = ""
) -> Progress | None:
    """Return a callback for one part of a computation; `name` precedes the notes.

    >>> report = share_of_progress(lambda done, note: print(done, note), 0.5, 0.25)
    >>> report(0.5, "second part") if report else None
    0.625 second part
    """
    if progress is None:
        return None
    prefix = f"{name}: " if name else ""
    return lambda done, note: progress(start + share * done, prefix + note)
