"""The valves that files and folders of `.vtp` surfaces and lines hold, and the frame each is looked at in."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from tables import InputFault
from vtp_reader import PolyData, read_vtp


@dataclass
class Valve:
    """A column of the picture: a surface with the leaflet number of each triangle, and lines."""

    title: str
    surface: PolyData
    leaflet: np.ndarray
    chords: list[PolyData] = field(default_factory=list)
    anterior: np.ndarray | None = None


# ---------------------------------------------------------------- reading


def welded(parts: list[PolyData]) -> PolyData:
    """Several surfaces as one; points at the same place are one, so that leaflets meet without a seam.

    Point arrays that all parts have are kept. Where leaflets meet, the first leaflet's value stands.
    """
    points = np.concatenate([part.points for part in parts])
    _, first, number = np.unique(points, axis=0, return_index=True, return_inverse=True)
    starts = np.cumsum([0] + [len(part.points) for part in parts])
    triangles = np.concatenate([part.triangles + start for part, start in zip(parts, starts)])
    arrays = {
        name: np.concatenate([part.point_arrays[name] for part in parts])[first]
        for name in parts[0].point_arrays
        if all(name in part.point_arrays for part in parts)
    }
    cells = {
        name: np.concatenate([part.triangle_arrays[name] for part in parts])
        for name in parts[0].triangle_arrays
        if all(name in part.triangle_arrays for part in parts)
    }
    none = np.zeros((0, 2), dtype=np.int64)
    return PolyData(parts[0].path, points[first], number.reshape(-1)[triangles], none, arrays, cells)


def one_valve(title: str, parts: list[PolyData], chords: list[PolyData]) -> Valve:
    """A valve from its leaflets' files, or from one file whose cell array `leaflet` tells them apart."""
    counted = np.concatenate([np.full(len(part.triangles), number) for number, part in enumerate(parts)])
    surface = welded(parts)
    leaflet = np.asarray(surface.triangle_arrays.get("leaflet", counted)).astype(int)
    return Valve(title, surface, leaflet, chords, named_anterior(parts))


def files_of(folder: Path) -> tuple[list[Path], list[Path]]:
    """The `.vtp` files of a folder: leaflets of a scene with its chords, and all others."""
    files = sorted(folder.glob("*.vtp"))
    leaflets = [file for file in files if file.name.startswith("leaflet_")]
    chords = [file for file in files if file.name.startswith("chords_")] if leaflets else []
    rest = [file for file in files if file not in leaflets and file not in chords]
    return leaflets + chords, sorted(rest, key=reading_order)


def reading_order(file: Path) -> tuple:
    """Open before closed before what is done after that; `chords` follows `closed`, `open_chords` `open`."""
    state = re.sub(r"^chords_?|_?chords$", "", file.stem)
    lines = state != file.stem
    known = {"open": 0, "before": 1, "closed": 2, "": 2, "after": 4}
    return known.get(state, 5), state or "closed", lines


def read_valves(paths: list[Path]) -> list[Valve]:
    """All valves that files and folders hold, in the order given."""
    valves: list[Valve] = []
    for path in paths:
        if path.is_dir():
            together, apart = files_of(path)
            if together:
                read = [read_vtp(file) for file in together]
                leaflets = [data for data in read if len(data.triangles)]
                if not leaflets:
                    raise InputFault(f"{path}: the leaflet files have no faces")
                valves.append(one_valve(path.name, leaflets, [data for data in read if len(data.segments)]))
            elif not apart:
                raise InputFault(f"{path}: no .vtp file in this folder")
        for file in apart if path.is_dir() else [path]:
            data = read_vtp(file)
            if len(data.triangles):
                valves.append(one_valve(file.stem.replace("_", " "), [data], []))
            elif not valves:
                raise InputFault(f"{file}: lines before any surface; give the surface first")
            if len(data.segments):
                valves[-1].chords.append(data)
    if not valves:
        raise InputFault("no surface in the files given")
    return told_apart(valves)


def told_apart(valves: list[Valve]) -> list[Valve]:
    """`before/closed.vtp` and `after/closed.vtp` are `closed` both: where files have one name, their folder's goes before it."""
    titles = [valve.title for valve in valves]
    for valve, title in zip(valves, titles):
        folder = Path(valve.surface.path).parent.name
        if titles.count(title) > 1 and folder:
            valve.title = f"{folder}: {title}"
    return valves


# ---------------------------------------------------------------- the valve's frame


def annulus_mask(data: PolyData) -> np.ndarray:
    """Which points the array `annulus` marks; none where there is no such array."""
    marks = data.point_arrays.get("annulus")
    return np.zeros(len(data.points), dtype=bool) if marks is None else np.asarray(marks).ravel() != 0


def named_anterior(parts: list[PolyData]) -> np.ndarray | None:
    """From the other leaflets' annulus to the anterior leaflet's, where a file is named for it."""
    ours, others = [], []
    for data in parts:
        (ours if "anterior" in data.path.stem else others).append(data.points[annulus_mask(data)])
    if not ours or not others or not sum(map(len, ours)) or not sum(map(len, others)):
        return None
    return np.concatenate(ours).mean(axis=0) - np.concatenate(others).mean(axis=0)


def valve_frame(valve: Valve, anterior: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Origin and axes (rows x, y anterior, z atrial): the annulus plane if marked, else the file's axes."""
    everything = valve.surface.points
    ring = everything[annulus_mask(valve.surface)]
    up = np.array([0.0, 0.0, 1.0])
    origin = everything.mean(axis=0)
    if len(ring) >= 3:
        origin = ring.mean(axis=0)
        up = np.linalg.svd(ring - origin, full_matrices=False)[2][2]
        up = up if up @ (origin - everything.mean(axis=0)) >= 0.0 else -up
    forward = np.array([0.0, 1.0, 0.0]) if anterior is None else anterior
    forward = forward - (forward @ up) * up
    if np.linalg.norm(forward) < 1e-6:
        forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
    forward = forward / np.linalg.norm(forward)
    return origin, np.stack([np.cross(forward, up), forward, up])
