"""Geometry of the 3-D view of a scene: triangles, edges, windows and sensors.

As the page renders the view in software, only the 40,000 largest triangles are drawn.
"""

from typing import Any

import numpy as np
from jaxtyping import Float, Int

from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import hexadecimal, value_colours
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import packed
from clerestory.report.mesh_lines import (
    feature_edges,
    horizontal_section,
    visible_extent,
    weld,
)
from clerestory.report.orientation import orientation

MOST_TRIANGLES = 40_000


def room_view(
    content: ReportContent, *, means: Float[np.ndarray, " sensor"], scale: ColourScale
) -> dict[str, Any]:
    """Return triangles, edges, windows and sensors of the 3-D view as JSON values.

    `means` is the mean illuminance of each sensor [lux], shown as colour.
    """
    chosen = largest_triangles(content.room.corners)
    vertices, faces = weld(content.room.corners[chosen])
    low, high = framed_box(content)
    windows = [
        {
            "name": window.name,
            "corners": window.corners.reshape(-1).round(4).tolist(),
            "centre": window.centre.round(4).tolist(),
            "normal": window.normal.round(5).tolist(),
            "up": window.up.round(5).tolist(),
            "doubt": bool(orientation(window, content).problem),
            "size": float(np.sqrt(max(window.area, 1e-4)).round(4)),
        }
        for window in content.windows
    ]
    return {
        "vertices": packed(vertices.astype(np.float32)),
        "faces": packed(faces.astype(np.uint32)),
        "colours": packed(np.round(255 * content.room.colour[chosen]).astype(np.uint8)),
        "edges": packed(feature_edges(vertices, faces).astype(np.uint32)),
        "windows": windows,
        "sensors": {
            "position": content.sensors.position.round(3).reshape(-1).tolist(),
            "direction": content.sensors.direction.round(4).reshape(-1).tolist(),
            "colour": hexadecimal(value_colours(scale, means)),
        },
        "low": low.round(3).tolist(),
        "high": high.round(3).tolist(),
        "north": content.north,
    }


def largest_triangles(
    corners: Float[np.ndarray, "triangle 3 3"],
) -> Int[np.ndarray, " kept"]:
    """Indices of the largest triangles, in ascending order."""
    sides = corners[:, 1:] - corners[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    kept = np.argsort(-area, kind="stable")[:MOST_TRIANGLES]
    return np.sort(kept[area[kept] > 0])


def framed_box(
    content: ReportContent,
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Bounding box [m] of the windows and of the room around the sensors."""
    position = content.sensors.position
    segments = horizontal_section(
        content.room.corners, height=float(np.median(position[:, 2]))
    )
    low, high = visible_extent(segments, position[:, :2])
    corners = content.room.corners.reshape(-1, 3)
    inside = np.all(
        (corners[:, :2] > low - 0.05) & (corners[:, :2] < high + 0.05), axis=1
    )
    near = np.abs(corners[:, 2] - position[:, 2].mean()) < 15
    points = [corners[inside & near], position]
    points += [window.corners.reshape(-1, 3) for window in content.windows]
    box = np.concatenate(points)
    return box.min(axis=0), box.max(axis=0)
