"""Progress reports of long computations."""

from collections.abc import Callable

# Called with the fraction done, 0…1, and a note such as the rate
Progress = Callable[[float, str], None]


def share_of_progress(
    progress: Progress | None, start: float, share: float, name: str = ""
) -> Progress | None:
    """Return a progress callback for the part of the work that begins at `start`.

    Parameters
    ----------
    start, share : beginning and length of the part, as fractions of the whole work
    name : prefix of the notes of the part

    Examples
    --------
    >>> report = share_of_progress(lambda done, note: print(done, note), 0.5, 0.25)
    >>> report(0.5, "second part") if report else None
    0.625 second part
    """
    if progress is None:
        return None
    prefix = f"{name}: " if name else ""
    return lambda done, note: progress(start + share * done, prefix + note)
