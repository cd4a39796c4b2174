"""To PyVista and from it, which is imported when a mesh is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coapt._arrays import FloatArray, IndexArray
from coapt._given import wrong_type
from coapt._meshes import LineArrays, SurfaceArrays, annulus_marks, chord_groups_of, closed_arrays, no_segments, no_triangles
from coapt._meshes import leaflets_of as leaflets_of_arrays
from coapt._optional import needed
from coapt._parts import ChordGroup, Leaflet

if TYPE_CHECKING:
    import pyvista
    from numpy.typing import NDArray

    from coapt._closed import Closed
    from coapt._valve import Valve


def leaflets(valve: Valve, positions_mm: FloatArray) -> pyvista.PolyData:
    """The leaflets in some position."""
    with needed("pyvista", "to_pyvista()"):
        import pyvista

    count = valve.leaflet_vertex_count
    mesh = pyvista.PolyData(positions_mm[:count].copy(), faces=_cells(valve.triangles))
    mesh.point_data["annulus"] = annulus_marks(valve)
    mesh.cell_data["leaflet"] = valve.triangle_leaflet.astype(np.float64)
    return mesh


def closed_leaflets(closed: Closed) -> pyvista.PolyData:
    """The closed leaflets with the arrays of ``closed.vtp``."""
    mesh = leaflets(closed.valve, closed.positions_mm)
    for name, values in closed_arrays(closed).items():
        mesh.point_data[name] = values
    return mesh


def closed_chords(closed: Closed) -> pyvista.PolyData:
    """The chordae with the arrays of ``chords.vtp``."""
    points_mm, segments = closed.chords
    mesh = _lines(points_mm, segments)
    mesh.cell_data["group"] = closed.valve.chord_groups[0].astype(np.float64)
    mesh.cell_data["force_n"] = closed.chord_forces_n
    return mesh


def _lines(points_mm: FloatArray, segments: IndexArray) -> pyvista.PolyData:
    with needed("pyvista", "chords_to_pyvista()"):
        import pyvista

    return pyvista.PolyData(points_mm.copy(), lines=_cells(segments))


def _cells(rows: IndexArray) -> NDArray[np.int64]:
    """Each row with its length before it, as VTK wants cells."""
    lengths = np.full(len(rows), rows.shape[1])
    return np.column_stack([lengths, rows]).astype(np.int64).ravel()


def leaflets_of(given: pyvista.PolyData | Mapping[str, pyvista.PolyData]) -> list[Leaflet]:
    """Leaflets of meshes by name, or of one mesh whose cells say which they belong to."""
    if isinstance(given, Mapping):
        return leaflets_of_arrays({name: _surface(name, mesh) for name, mesh in given.items()})
    if not hasattr(given, "is_all_triangles"):
        raise wrong_type("leaflets", given, "a PyVista PolyData, or one for each name")
    return leaflets_of_arrays(_surface("leaflets", given))


def _surface(name: str, mesh: pyvista.PolyData) -> SurfaceArrays:
    if not mesh.is_all_triangles:
        raise no_triangles(name, "`mesh.triangulate()`")
    return SurfaceArrays(
        np.asarray(mesh.points),
        np.asarray(mesh.regular_faces, dtype=np.int64),
        _array(mesh.point_data, "annulus"),
        _array(mesh.cell_data, "leaflet"),
    )


def chord_groups(given: Mapping[str, pyvista.PolyData]) -> list[ChordGroup]:
    """Groups of chordae of line meshes by name."""
    return chord_groups_of({name: _segments(name, mesh) for name, mesh in given.items()})


def _segments(name: str, mesh: pyvista.PolyData) -> LineArrays:
    cells = np.asarray(mesh.lines, dtype=np.int64)
    if cells.size == 0 or cells.size % 3 or np.any(cells[::3] != 2):
        raise no_segments(name)
    return LineArrays(
        np.asarray(mesh.points),
        cells.reshape(-1, 3)[:, 1:],
        _array(mesh.cell_data, "rest_length_mm"),
        _array(mesh.cell_data, "area_mm2"),
    )


def _array(data: pyvista.DataSetAttributes, key: str) -> NDArray[Any] | None:
    return np.asarray(data[key]) if key in data else None
