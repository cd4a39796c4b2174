"""A small painter: shaded triangles and round lines on a matplotlib axis, drawn from far to near.

No graphics hardware is needed, so the same picture comes out on a laptop and on a build server.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.collections import PolyCollection

# Where the light comes from, in the viewer's frame: right, up, towards the viewer.
KEY_LIGHT = np.array([-0.45, 0.65, 0.75]) / np.linalg.norm([-0.45, 0.65, 0.75])


@dataclass
class Strokes:
    """Things to be painted: polygons (2 points are a line), colours, line widths [pt], nearness [mm]."""

    outlines: list[np.ndarray]
    faces: np.ndarray
    edges: np.ndarray
    widths: np.ndarray
    depth: np.ndarray


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length one; a zero vector stays."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)


def looking_from(direction: list[float]) -> np.ndarray:
    """Rows to the right, up, towards the viewer, for a viewer in this direction with z upright."""
    towards = unit(np.array(direction, dtype=float))
    right = unit(np.cross([0.0, 0.0, 1.0], towards))
    return np.stack([right, np.cross(towards, right), towards])


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted normals, shape (point, 3)."""
    corners = points[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], face)
    return unit(normals)


def subdivided(corners: np.ndarray) -> np.ndarray:
    """Each triangle's corner values, (m, 3, n), cut into four at the middles of the edges: (4 m, 3, n)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return np.stack([np.stack(part, axis=1) for part in parts], axis=1).reshape(-1, 3, corners.shape[2])


def shade(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Brightness and highlight of surfaces lit from both sides; normals in the viewer's frame."""
    facing = normals * np.where(normals[:, 2:] < 0.0, -1.0, 1.0)
    # Wrapped round the terminator, so that leaflets which hang away from the light still show their shape.
    diffuse = (0.5 + 0.5 * facing @ KEY_LIGHT) ** 1.4
    brightness = 0.42 + 0.50 * diffuse + 0.12 * facing[:, 2]
    half = unit(KEY_LIGHT + np.array([0.0, 0.0, 1.0]))
    return brightness, 0.22 * np.clip(facing @ half, 0.0, 1.0) ** 28


def surface(corners: np.ndarray, normals: np.ndarray, colours: np.ndarray, data: bool = False) -> Strokes:
    """Shaded triangles: corners (m, 3, 3) and normals (m, 3) in the viewer's frame, RGB (m, 3).

    Colours that stand for `data` are shaded little, so that they can be read off the colour bar.
    """
    brightness, highlight = shade(unit(normals))
    light = brightness[:, None]
    if data:
        rgb = np.clip(colours * (0.7 + 0.3 * light) + 0.3 * highlight[:, None], 0.0, 1.0)
    else:
        # Shadows grow more saturated as they darken, as tissue does, instead of grey.
        rgb = colours ** np.clip(1.9 - 0.9 * light, 0.8, 1.6) * (0.5 + 0.5 * light)
        rgb = np.clip(rgb + highlight[:, None], 0.0, 1.0)
    # Edges in the face's colour hide the hairlines that antialiasing leaves between neighbours.
    widths = np.full(len(corners), 0.6)
    return Strokes(list(corners[:, :, :2]), rgb, rgb, widths, corners[:, :, 2].mean(axis=1))


def lines(
    ends: np.ndarray, colour: tuple, width_pt: float, towards_mm: float, step_mm: float = 0.6
) -> Strokes:
    """Segments (k, 2, 3) in the viewer's frame, cut short so that they sort well, drawn a little nearer."""
    pieces = []
    for a, b in ends:
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / step_mm)))
        stations = a + (b - a) * np.linspace(0.0, 1.0, count + 1)[:, None]
        pieces.extend(np.stack([stations[:-1], stations[1:]], axis=1))
    pieces = np.array(pieces).reshape(-1, 2, 3)
    rgb = np.tile(np.array(colour, dtype=float), (len(pieces), 1))
    depth = pieces[:, :, 2].mean(axis=1) + towards_mm
    return Strokes(list(pieces[:, :, :2]), rgb, rgb, np.full(len(pieces), width_pt), depth)


def paint(axis, layers: list[Strokes]) -> None:
    """Draws everything, the farthest first."""
    depth = np.concatenate([layer.depth for layer in layers])
    order = np.argsort(depth, kind="stable")
    outlines = [outline for layer in layers for outline in layer.outlines]
    stacked = [
        np.concatenate([getattr(layer, name) for layer in layers])[order]
        for name in ("faces", "edges", "widths")
    ]
    collection = PolyCollection(
        [outlines[number] for number in order],
        facecolors=stacked[0],
        edgecolors=stacked[1],
        linewidths=stacked[2],
        capstyle="round",
        joinstyle="round",
    )
    axis.add_collection(collection)
