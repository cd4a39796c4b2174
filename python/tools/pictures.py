#!/usr/bin/env python3
"""Draws valves: the surfaces and chordae that coapt reads and writes, shaded and to scale, on any machine.

    pictures.py DIR_OR_FILES... -o picture.png [--views above,side,front] [--color strain]

Each surface file is a column, each view a row. A folder gives its `leaflet_*.vtp` together as one valve, and
every other surface in it (`open.vtp`, `closed.vtp`, ...) as one each; a file of lines belongs to the surface
before it. Needs numpy and matplotlib. Exit status: 0 written, 2 wrong usage or wrong input. See README.md.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

try:
    import matplotlib
    import numpy as np
except ModuleNotFoundError as missing:
    print(f"pictures.py needs numpy and matplotlib: {missing}; try pip install numpy matplotlib", file=sys.stderr)
    raise SystemExit(2) from None

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import painter  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402
from tables import InputFault  # noqa: E402
from valves import Valve, annulus_mask, read_valves, valve_frame  # noqa: E402
from vtp_reader import PolyData  # noqa: E402

FOOTER = "coapt - research use, not a medical device"
# Leaflets seen from the atrium, then from the ventricle. Told apart by lightness as well as by hue.
ATRIAL_RGB = np.array([[0.96, 0.76, 0.66], [0.86, 0.58, 0.50], [0.95, 0.83, 0.62]])
VENTRICULAR_RGB = np.array([[0.66, 0.70, 0.78], [0.54, 0.58, 0.68], [0.70, 0.74, 0.74]])
CHORD_RGB, CHORD_EDGE_RGB = (0.93, 0.88, 0.74), (0.36, 0.30, 0.26)
ANNULUS_RGB, MARGIN_RGB, MISSING_RGB = (0.13, 0.25, 0.42), (0.30, 0.16, 0.14), (0.6, 0.6, 0.6)
# Rows of a view: to the right, up, towards the viewer, in the valve's frame x, y anterior, z to the atrium.
VIEWS = {
    "above": np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]),
    "front": np.array([[-1.0, 0, 0], [0, 0, 1.0], [0, 1.0, 0]]),
    "side": np.array([[0, 1.0, 0], [0, 0, 1.0], [1.0, 0, 0]]),
    "oblique": painter.looking_from([0.35, -0.8, 1.0]),
}
VIEW_WORDS = {
    "above": "from the atrium",
    "front": "from the front",
    "side": "from the side",
    "oblique": "from the atrium, oblique",
}
TRIANGLES_AT_MOST = 24000


# ---------------------------------------------------------------- colours


def triangle_scalar(data: PolyData, name: str) -> np.ndarray | None:
    """The array at the triangles' corners, (m, 3); vectors by their length."""
    if name in data.point_arrays:
        values = np.asarray(data.point_arrays[name], dtype=float)
        values = np.linalg.norm(values, axis=1) if values.ndim > 1 else values
        return values[data.triangles]
    if name in data.triangle_arrays:
        values = np.asarray(data.triangle_arrays[name], dtype=float)
        values = np.linalg.norm(values, axis=1) if values.ndim > 1 else values
        return np.repeat(values[:, None], 3, axis=1)
    return None


def colour_limits(valves: list[Valve], name: str) -> Normalize:
    """One scale for all columns: the 1st to the 99th percentile of the finite values."""
    found = [triangle_scalar(valve.surface, name) for valve in valves]
    found = [values.ravel() for values in found if values is not None]
    if not found:
        arrays = {key for v in valves for key in (*v.surface.point_arrays, *v.surface.triangle_arrays)}
        raise InputFault(f"no surface has an array '{name}'; they have {', '.join(sorted(arrays)) or 'none'}")
    values = np.concatenate(found)
    values = values[np.isfinite(values)]
    low, high = np.percentile(values, [1.0, 99.0]) if len(values) else (0.0, 1.0)
    return Normalize(low, high if high > low else low + 1.0)


def scalar_label(name: str) -> str:
    """`gap_mm` as `gap [mm]`."""
    for unit in ("mm", "mpa", "n", "mm2"):
        if name.endswith(f"_{unit}"):
            shown = {"mpa": "MPa", "n": "N", "mm2": "mm²"}.get(unit, unit)
            return f"{name[: -len(unit) - 1].replace('_', ' ')} [{shown}]"
    return name.replace("_", " ")


# ---------------------------------------------------------------- drawing


def boundary_segments(data: PolyData) -> tuple[np.ndarray, np.ndarray]:
    """Edges of one triangle only, and whether both ends are annulus."""
    edges = np.concatenate([data.triangles[:, [0, 1]], data.triangles[:, [1, 2]], data.triangles[:, [2, 0]]])
    count = Counter(map(tuple, np.sort(edges, axis=1).tolist()))
    border = np.array([edge for edge, times in count.items() if times == 1], dtype=np.int64).reshape(-1, 2)
    return border, annulus_mask(data)[border].all(axis=1)


def surface_strokes(
    data: PolyData, leaflet: np.ndarray, points: np.ndarray, options, scale
) -> painter.Strokes:
    """The shaded triangles of a surface whose points are given in the viewer's frame."""
    normals = painter.vertex_normals(points, data.triangles)
    scalar = triangle_scalar(data, options.color) if options.color else None
    scalar = np.full(data.triangles.shape, np.nan) if scalar is None else scalar
    corners = np.concatenate([points[data.triangles], normals[data.triangles], scalar[:, :, None]], axis=2)
    while not options.flat and len(corners) * 4 <= TRIANGLES_AT_MOST:
        corners, leaflet = painter.subdivided(corners), np.repeat(leaflet, 4)
    places = corners[:, :, :3]
    flat = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    facing = flat if options.flat else corners[:, :, 3:6].mean(axis=1)
    tint = np.mod(leaflet, len(ATRIAL_RGB))
    rgb = np.where((flat[:, 2] >= 0.0)[:, None], ATRIAL_RGB[tint], VENTRICULAR_RGB[tint])
    if scale is None:
        return painter.surface(places, facing, rgb)
    values = corners[:, :, 6].mean(axis=1)
    rgb = plt.get_cmap(options.map)(scale(np.nan_to_num(values)))[:, :3]
    rgb = np.where(np.isfinite(values)[:, None], rgb, MISSING_RGB)
    return painter.surface(places, facing, rgb, data=True)


def valve_layers(valve: Valve, frame, view: np.ndarray, options, scale) -> list[painter.Strokes]:
    """Everything of a valve in one view, in the viewer's frame."""
    origin, axes = frame
    turn = (view @ axes).T
    points = (valve.surface.points - origin) @ turn
    border, annulus = boundary_segments(valve.surface)
    layers = [
        surface_strokes(valve.surface, valve.leaflet, points, options, scale),
        painter.lines(points[border[~annulus]], MARGIN_RGB, 0.9, 0.15),
        painter.lines(points[border[annulus]], ANNULUS_RGB, 2.4, 0.6),
    ]
    dense = sum(len(data.segments) for data in valve.chords) > 600
    for data in valve.chords:
        ends = ((data.points - origin) @ turn)[data.segments]
        # The dark rim lies behind by more than a piece is long, else the next rim would cover this piece.
        layers.append(painter.lines(ends, CHORD_EDGE_RGB, 1.3 if dense else 1.8, -0.7))
        layers.append(painter.lines(ends, CHORD_RGB, 0.6 if dense else 1.0, 0.05))
    return [layer for layer in layers if len(layer.depth)]


def extent(layers: list[painter.Strokes]) -> np.ndarray:
    """Lowest and highest screen coordinates, (2, 2)."""
    points = np.concatenate([outline for layer in layers for outline in layer.outlines])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def scale_bar(axis, box: np.ndarray) -> None:
    """A bar of 10 mm in the lower left corner."""
    x, y = box[0] + np.array([0.0, -0.05]) * (box[1] - box[0])
    axis.plot([x, x + 10.0], [y, y], color="0.15", linewidth=2.5, solid_capstyle="butt")
    axis.annotate(
        "10 mm", (x + 5.0, y), (0, 3), textcoords="offset points", ha="center", fontsize=8, color="0.15"
    )


def draw(valves: list[Valve], options: argparse.Namespace) -> None:
    """Draws the whole picture into the file."""
    scale = colour_limits(valves, options.color) if options.color else None
    if scale is not None and options.limits:
        scale = Normalize(*options.limits)
    given = np.array(options.anterior) if options.anterior else None
    named = next((valve.anterior for valve in valves if valve.anterior is not None), None)
    anterior = given if given is not None else named
    frames = [valve_frame(valve, anterior) for valve in valves]
    grid = [
        [valve_layers(v, f, VIEWS[view], options, scale) for v, f in zip(valves, frames)]
        for view in options.views
    ]
    boxes = []
    for row in grid:
        all_boxes = np.array([extent(layers) for layers in row])
        boxes.append(np.stack([all_boxes[:, 0].min(axis=0), all_boxes[:, 1].max(axis=0)]))
    figure, axes = figure_for(boxes, len(valves), scale is not None)
    for row, (view, box) in enumerate(zip(options.views, boxes)):
        for column, valve in enumerate(valves):
            axis = axes[row][column]
            painter.paint(axis, grid[row][column])
            pad = 0.09 * (box[1] - box[0]).max()
            axis.set(xlim=(box[0][0] - pad, box[1][0] + pad), ylim=(box[0][1] - pad, box[1][1] + pad))
            axis.set_aspect("equal")
            axis.axis("off")
            if row == 0:
                axis.set_title(valve.title, fontsize=13, color="0.1", pad=10)
            if column == 0:
                scale_bar(axis, box)
                axis.text(-0.02, 0.5, VIEW_WORDS[view], transform=axis.transAxes, rotation=90, fontsize=9,
                          ha="right", va="center", color="0.4")  # fmt: skip
            if view == "above" and anterior is not None:
                axis.text(
                    0.5,
                    1.0,
                    "anterior",
                    transform=axis.transAxes,
                    fontsize=8,
                    ha="center",
                    va="top",
                    color="0.4",
                )
    finish(figure, axes, options, scale)


def figure_for(boxes: list[np.ndarray], columns: int, bar: bool):
    """A figure whose panels have the shape of what they show; one scale along each row."""
    width = 4.6
    spans = [(box[1] - box[0]) + 0.18 * (box[1] - box[0]).max() for box in boxes]
    heights = [width * span[1] / span[0] for span in spans]
    size = (width * columns + (1.1 if bar else 0.4), sum(heights) + 1.1)
    figure, axes = plt.subplots(
        len(boxes),
        columns,
        figsize=size,
        squeeze=False,
        gridspec_kw={"height_ratios": heights},
        layout="constrained",
    )
    return figure, axes


def finish(figure, axes, options, scale) -> None:
    """Colour bar, title, the line on what this is for; writes the file."""
    if scale is not None:
        mappable = plt.cm.ScalarMappable(scale, options.map)
        bar = figure.colorbar(mappable, ax=axes, shrink=0.6, aspect=30, extend="both", pad=0.02)
        bar.set_label(scalar_label(options.color))
        bar.outline.set_visible(False)
    if options.title:
        figure.suptitle(options.title, fontsize=15, color="0.1")
    figure.supxlabel(FOOTER, fontsize=8, color="0.45")
    try:
        # No date and no version in the file: the same input gives the same bytes.
        figure.savefig(
            options.output, dpi=options.dpi, facecolor="white", metadata=plain_metadata(options.output)
        )
    except (OSError, ValueError) as error:
        raise InputFault(f"{options.output}: {error}") from None
    plt.close(figure)


def plain_metadata(path: Path) -> dict:
    """What keeps the file free of dates and version numbers, by format."""
    return {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(
        path.suffix, {}
    )


# ---------------------------------------------------------------- command line


def view_names(text: str) -> list[str]:
    """`above,side` as a list."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in VIEWS:
            raise argparse.ArgumentTypeError(f"unknown view '{name}'; expected {', '.join(VIEWS)}")
    return names


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], allow_abbrev=False)
    top.add_argument("paths", type=Path, nargs="+", metavar="DIR_OR_FILE")
    top.add_argument("-o", "--output", type=Path, required=True, help="picture to write (.png, .svg, .pdf)")
    top.add_argument("--views", type=view_names, default=["above", "front"], help=f"of {', '.join(VIEWS)}")
    top.add_argument(
        "--color", metavar="ARRAY", help="colour by this point or cell array, such as strain or gap_mm"
    )
    top.add_argument(
        "--limits", type=float, nargs=2, metavar=("LOW", "HIGH"), help="ends of the colour scale"
    )
    top.add_argument("--map", default="cividis", choices=("cividis", "viridis"), help="colour map")
    top.add_argument(
        "--anterior", type=float, nargs=3, metavar=("X", "Y", "Z"), help="direction to the anterior side"
    )
    top.add_argument("--title", help="above the whole picture")
    top.add_argument("--titles", nargs="+", help="one for each column")
    top.add_argument("--flat", action="store_true", help="one shade per triangle, as computed")
    top.add_argument("--dpi", type=int, default=160)
    return top


def main(arguments: list[str] | None = None) -> int:
    """Reads the command line and draws."""
    options = parser().parse_args(arguments)
    try:
        valves = read_valves(options.paths)
        if options.titles and len(options.titles) != len(valves):
            raise InputFault(f"--titles: {len(options.titles)} titles for {len(valves)} valves")
        for valve, title in zip(valves, options.titles or []):
            valve.title = title
        draw(valves, options)
    except InputFault as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 2
    print(options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
