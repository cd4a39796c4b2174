"""To PyVista and from it, which is imported when a mesh is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from coapt._arrays import FloatArray, IndexArray
from coapt._errors import Fault, InputError
from coapt._valve import ChordGroup, Leaflet, Valve

if TYPE_CHECKING:
    import pyvista
    from numpy.typing import NDArray

    from coapt._closed import Closed


def leaflets(valve: Valve, positions_mm: FloatArray) -> pyvista.PolyData:
    """The leaflets in some position."""
    import pyvista

    count = valve.leaflet_vertex_count
    mesh = pyvista.PolyData(positions_mm[:count].copy(), faces=_cells(valve.triangles))
    on_annulus = np.zeros(count)
    on_annulus[valve.annulus] = 1.0
    mesh.point_data["annulus"] = on_annulus
    mesh.cell_data["leaflet"] = valve.triangle_leaflet.astype(np.float64)
    return mesh


def closed_leaflets(closed: Closed) -> pyvista.PolyData:
    """The closed leaflets with the arrays of ``closed.vtp``."""
    valve = closed.valve
    mesh = leaflets(valve, closed.positions_mm)
    gap_mm, contact, strain = closed._native.at_points()
    mesh.point_data["gap_mm"] = gap_mm
    mesh.point_data["contact"] = contact.astype(np.float64)
    mesh.point_data["strain"] = strain
    count = valve.leaflet_vertex_count
    mesh.point_data["displacement_mm"] = closed.positions_mm[:count] - valve.points_mm[:count]
    return mesh


def closed_chords(closed: Closed) -> pyvista.PolyData:
    """The chordae with the arrays of ``chords.vtp``."""
    points_mm, segments = closed.chords
    mesh = _lines(points_mm, segments)
    mesh.cell_data["group"] = closed.valve.chord_groups[0].astype(np.float64)
    mesh.cell_data["force_n"] = closed.chord_forces_n
    return mesh


def _lines(points_mm: FloatArray, segments: IndexArray) -> pyvista.PolyData:
    import pyvista

    return pyvista.PolyData(points_mm.copy(), lines=_cells(segments))


def _cells(rows: IndexArray) -> NDArray[np.int64]:
    """Each row with its length before it, as VTK wants cells."""
    lengths = np.full(len(rows), rows.shape[1])
    return np.column_stack([lengths, rows]).astype(np.int64).ravel()


NAMES = ("anterior", "posterior")
"""Leaflets of a mesh that tells them apart by number, as coapt writes them."""


def leaflets_of(given: pyvista.PolyData | Mapping[str, pyvista.PolyData]) -> list[Leaflet]:
    """Leaflets of meshes by name, or of one mesh whose cells say which they belong to."""
    if isinstance(given, Mapping):
        return [_leaflet(name, mesh, None) for name, mesh in given.items()]
    if "leaflet" not in given.cell_data:
        return [_leaflet("leaflet", given, None)]
    of_cell = np.asarray(given.cell_data["leaflet"]).astype(np.int64)
    numbers = np.unique(of_cell)
    names = [NAMES[number] if 0 <= number < len(NAMES) else f"leaflet {number}" for number in numbers]
    return [_leaflet(name, given, of_cell == number) for name, number in zip(names, numbers)]


def _leaflet(name: str, mesh: pyvista.PolyData, own: NDArray[np.bool_] | None) -> Leaflet:
    if not mesh.is_all_triangles:
        raise InputError([Fault(name, "has cells that are no triangles; expected triangles (`mesh.triangulate()`)")])
    triangles = np.asarray(mesh.regular_faces, dtype=np.int64)
    triangles = triangles if own is None else triangles[own]
    used, numbered = np.unique(triangles, return_inverse=True)
    marks = None
    if "annulus" in mesh.point_data:
        on_annulus = np.asarray(mesh.point_data["annulus"])[used] > 0.5
        marks = np.flatnonzero(on_annulus).astype(np.int64)
    return Leaflet(
        name,
        np.ascontiguousarray(np.asarray(mesh.points)[used], dtype=np.float64),
        np.ascontiguousarray(numbered.reshape(-1, 3).astype(np.int64)),
        annulus_points=marks,
    )


def chord_groups(given: Mapping[str, pyvista.PolyData]) -> list[ChordGroup]:
    """Groups of chordae of line meshes by name."""
    return [_chord_group(name, mesh) for name, mesh in given.items()]


def _chord_group(name: str, mesh: pyvista.PolyData) -> ChordGroup:
    cells = np.asarray(mesh.lines, dtype=np.int64)
    if cells.size == 0 or cells.size % 3 or np.any(cells[::3] != 2):
        raise InputError([Fault(name, "has cells that are no segments; expected lines of two points each")])

    def array(key: str) -> FloatArray | None:
        return np.ascontiguousarray(mesh.cell_data[key], dtype=np.float64) if key in mesh.cell_data else None

    return ChordGroup(
        name,
        np.ascontiguousarray(mesh.points, dtype=np.float64),
        np.ascontiguousarray(cells.reshape(-1, 3)[:, 1:]),
        rest_length_mm=array("rest_length_mm"),
        area_mm2=array("area_mm2"),
    )
