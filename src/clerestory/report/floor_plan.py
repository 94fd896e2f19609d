"""False-colour floor plans of sensor values.

Walls are the horizontal section of the scene at the height of the sensors. Grids that
face up or down are drawn as cells, other grids as one arrow per sensor.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import hexadecimal, value_colours
from clerestory.report.content import ReportContent, WindowSurface
from clerestory.report.markup import Markup, drawing, element, join
from clerestory.report.mesh_lines import (
    feature_edges,
    horizontal_section,
    visible_extent,
    weld,
)
from clerestory.report.metric_maps import MetricMap
from clerestory.report.orientation import orientation
from clerestory.scene.sensor_cells import sensor_cells

_WIDTH, _HEIGHT = 320.0, 380.0
_MARGIN, _FOOT = 16.0, 30.0
_MOST_SEGMENTS = 12_000


@dataclass(frozen=True, eq=False)
class PlanFrame:
    """Extent, walls and sensors of a floor plan, common to all metrics of a grid.

    Coordinates are in metres. `identifier` is the HTML identifier of the walls.
    """

    identifier: str
    low: Float[np.ndarray, "2"]
    high: Float[np.ndarray, "2"]
    scale: float  # drawing units per metre
    walls: str  # SVG path data
    level: bool  # whether most sensors face up or down
    cells: Float[np.ndarray, "sensor corner 2"]  # outlines of cells or arrows
    points: Float[np.ndarray, "sensor 2"]

    def place(
        self, points: Float[np.ndarray, "*batch 2"]
    ) -> Float[np.ndarray, "*batch 2"]:
        """Convert scene coordinates x, y [m] into drawing coordinates; +y is up."""
        x = _MARGIN + (points[..., 0] - self.low[0]) * self.scale
        y = _MARGIN + (self.high[1] - points[..., 1]) * self.scale
        return np.stack([x, y], axis=-1)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the plan in drawing units."""
        width, height = (self.high - self.low) * self.scale + 2 * _MARGIN
        return float(width), float(height) + _FOOT


def plan_frame(
    content: ReportContent, members: Int[np.ndarray, " member"], *, identifier: str
) -> PlanFrame:
    """Return the frame of a plan showing the room visible from the given sensors."""
    position, direction = content.sensors.position, content.sensors.direction
    return frame_around(
        content, position[members], direction[members], identifier=identifier
    )


def frame_around(
    content: ReportContent,
    position: Float[np.ndarray, "point 3"],
    direction: Float[np.ndarray, "point 3"],
    *,
    identifier: str,
) -> PlanFrame:
    """Return the frame of a plan showing the room visible from sensors or eyes."""
    points = position[:, :2]
    height = float(np.median(position[:, 2]))
    segments = horizontal_section(content.room.corners, height=height)
    low, high = visible_extent(segments, points)
    for window in content.windows:
        corners = window.corners[:, :, :2].reshape(-1, 2)
        near = np.linalg.norm(window.centre[:2] - points.mean(axis=0)) < 50
        low = np.minimum(low, corners.min(axis=0)) if near else low
        high = np.maximum(high, corners.max(axis=0)) if near else high

    # Extent of the plan at least 2 m, as for a single sensor outdoors
    lack = np.maximum(0, 2.0 - (high - low)) / 2 + 0.02
    low, high = low - lack, high + lack
    scale = float(np.min((_WIDTH, _HEIGHT) / (high - low)))

    level = bool(np.median(np.abs(direction[:, 2])) > 0.7)
    cells = (
        sensor_cells(points)
        if level
        else _arrows(points, direction[:, :2], size=36 / scale)
    )
    frame = PlanFrame(identifier, low, high, scale, "", level, cells, points)
    inside = np.all((segments > low - 1) & (segments < high + 1), axis=2).any(axis=1)
    return replace(frame, walls=_paths(frame.place(_longest(segments[inside]))))


def plan(
    frame: PlanFrame,
    metric: MetricMap,
    members: Int[np.ndarray, " member"],
    *,
    scale: ColourScale,
    content: ReportContent,
    label: str,
) -> Markup:
    """Return the false-colour plan of one metric at the given sensors."""
    colours = hexadecimal(value_colours(scale, metric.values[members]))
    cells = frame.place(frame.cells)

    # One SVG path per colour keeps pages of many sensors small
    painted = [
        element(
            "path",
            d=_paths(cells[[k for k, used in enumerate(colours) if used == colour]]),
            fill=colour,
            stroke=colour,
        )
        for colour in dict.fromkeys(colours)
    ]
    return plan_drawing(
        frame,
        content,
        label,
        element("g", *painted, class_="cells"),
        data_arrows=None if frame.level else 1,
        data_metric=metric.key,
        data_grid=frame.identifier,
    )


def plan_drawing(
    frame: PlanFrame,
    content: ReportContent,
    label: str,
    painted: Markup,
    *marks: Markup,
    **attributes: object,
) -> Markup:
    """Return a plan: `painted`, walls and windows, `marks`, scale bar and north."""
    width, height = frame.size
    return drawing(
        label,
        painted,
        element("use", href=f"#{frame.identifier}", class_="halo"),
        element("use", href=f"#{frame.identifier}", class_="walls"),
        *(
            _window(frame, window, reversed_=bool(orientation(window, content).problem))
            for window in content.windows
        ),
        *(marks or [element("circle", class_="chosen", r=5, cx=-99, cy=-99)]),
        _scale_bar(frame),
        _north_arrow(frame, content.north),
        width=width,
        height=height,
        **{"class_": "plan", **attributes},
    )


def walls_definition(frame: PlanFrame) -> Markup:
    """Return the walls as an SVG definition, used by the plans of all metrics."""
    path = element("path", d=frame.walls, id=frame.identifier)
    return element(
        "svg", element("defs", path), class_="definitions", aria_hidden="true"
    )


def _arrows(
    points: Float[np.ndarray, "sensor 2"],
    towards: Float[np.ndarray, "sensor 2"],
    *,
    size: float,
) -> Float[np.ndarray, "sensor corner 2"]:
    # Outlines of arrows that start at the sensors and point in their directions
    length = np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-6)
    ahead = size * towards / length
    aside = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
    half = [(0, 0.09), (0.5, 0.09), (0.5, 0.26)]
    outline = [*half, (1, 0), *((a, -b) for a, b in reversed(half))]
    return np.stack([points + a * ahead + b * aside for a, b in outline], axis=1)


def _longest(
    segments: Float[np.ndarray, "segment 2 2"],
) -> Float[np.ndarray, "kept 2 2"]:
    # Keep only the longest wall segments if there are too many
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    return segments[np.sort(np.argsort(-length)[:_MOST_SEGMENTS])]


def _paths(outlines: Float[np.ndarray, "outline corner 2"]) -> str:
    # SVG path data of closed outlines, or of segments between two points
    end = "Z" if outlines.shape[1] > 2 else ""
    return "".join(
        "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in outline) + end
        for outline in outlines.tolist()
    )


def _window(frame: PlanFrame, window: WindowSurface, *, reversed_: bool) -> Markup:
    vertices, faces = weld(window.corners)
    outline = frame.place(vertices[feature_edges(vertices, faces)[:, :2], :2])
    overhead = " overhead" if abs(window.normal[2]) > 0.7 else ""
    glass = element("path", d=_paths(outline), class_=f"window{overhead}")
    flat = window.normal[:2]
    if np.linalg.norm(flat) < 0.3:
        return glass
    tail, tip = frame.place(
        np.stack([window.centre[:2], window.centre[:2] + flat * 22 / frame.scale])
    )
    return join(glass, _arrow(tail, tip, "normal wrong" if reversed_ else "normal"))


def _arrow(
    tail: Float[np.ndarray, "2"], tip: Float[np.ndarray, "2"], class_: str
) -> Markup:
    ahead = (tip - tail) / np.linalg.norm(tip - tail)
    aside = np.array([-ahead[1], ahead[0]])
    neck = tip - 7 * ahead
    head = np.stack([tip, neck + 3.5 * aside, neck - 3.5 * aside])[None]
    return element(
        "g",
        element("path", d=_paths(np.stack([tail, neck])[None])),
        element("path", d=_paths(head), class_="head"),
        class_=class_,
    )


def _scale_bar(frame: PlanFrame) -> Markup:
    # Choose a length of 1, 2 or 5 × 10ⁿ m that is nearest to 70 drawing units
    lengths = np.outer(10.0 ** np.arange(-3, 5), (1, 2, 5)).ravel()
    length = float(lengths[np.argmin(np.abs(np.log(lengths * frame.scale / 70)))])
    x, y = _MARGIN, frame.size[1] - 12
    end = x + length * frame.scale
    return element(
        "g",
        element("path", d=f"M{x:.1f},{y - 4:.1f}v4H{end:.1f}v-4"),
        element("text", f"{length:g} m", x=f"{end + 6:.1f}", y=f"{y:.1f}"),
        class_="scale-bar",
    )


def _north_arrow(frame: PlanFrame, north: float) -> Markup:
    # `north` is the azimuth of +y, so north is turned counter-clockwise from +y
    ahead = np.array([-np.sin(north), -np.cos(north)])
    middle = np.array([frame.size[0] - _MARGIN - 10, frame.size[1] - 16])
    letter = middle - 1.9 * 9 * np.array([1, 0])
    return element(
        "g",
        _arrow(middle - 9 * ahead, middle + 9 * ahead, "needle"),
        element("text", "N", x=f"{letter[0]:.1f}", y=f"{letter[1] + 4:.1f}"),
        class_="north",
    )
