"""Places of the numbers of dots in a plot, clear of dots and of each other."""

from collections.abc import Iterator, Sequence

# Width of a digit, height of a number, and distance from the rim of a dot
_DIGIT, _HEIGHT, _GAP = 7.5, 9.0, 3.0

Box = tuple[float, float, float, float]


def label_places(
    dots: Sequence[tuple[float, float]], *, radius: float
) -> list[tuple[float, float]]:
    """Return the left ends of the baselines of the numbers 1, 2, … of dots.

    y points down. Each number takes the first place around its dot that is clear of all
    dots and of the numbers before it, or the first place if there is none.

    >>> label_places([(0.0, 0.0), (0.0, 0.0)], radius=6.0)
    [(9.0, -6.0), (9.0, 4.5)]
    """
    taken = [(x - radius, y - radius, x + radius, y + radius) for x, y in dots]
    found = []
    for at, dot in enumerate(dots, start=1):
        width = _DIGIT * len(str(at))
        places = list(_around(dot, radius, width))
        clear = (p for p in places if not _covered(_box(p, width), taken))
        place = next(clear, places[0])
        found.append(place)
        taken.append(_box(place, width))
    return found


def _around(
    dot: tuple[float, float], radius: float, width: float
) -> Iterator[tuple[float, float]]:
    # Beside, above and below the dot; then further away
    (x, y), away = dot, radius + _GAP
    right, left, middle = x + away, x - away - width, x - width / 2
    for side in (right, left):
        for down in (-radius, _HEIGHT / 2, radius + _HEIGHT):
            yield side, y + down
    yield middle, y - away
    yield middle, y + away + _HEIGHT
    for side in (right, left, middle):
        yield side, y - away - _HEIGHT
        yield side, y + away + 2 * _HEIGHT


def _box(place: tuple[float, float], width: float) -> Box:
    x, y = place
    return x, y - _HEIGHT, x + width, y


def _covered(box: Box, taken: Sequence[Box]) -> bool:
    left, top, right, bottom = box
    return any(
        left < other[2] and other[0] < right and top < other[3] and other[1] < bottom
        for other in taken
    )
