"""Leaflets and chordae as plain arrays, between the package and whatever holds meshes: PyVista, 3D Slicer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from coapt._arrays import FloatArray
from coapt._errors import Fault, InputError
from coapt._parts import ChordGroup, Leaflet

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coapt._closed import Closed
    from coapt._valve import Valve

#: Names of leaflets where they are told apart by number, as coapt writes them.
NAMES = ("anterior", "posterior")


class SurfaceArrays(NamedTuple):
    """A triangle mesh."""

    #: Points [mm], shape (n, 3).
    points_mm: NDArray[Any]
    #: Point numbers from 0, shape (m, 3).
    triangles: NDArray[np.int64]
    #: Above a half on the annulus, shape (n,); None where it is not marked.
    annulus: NDArray[Any] | None
    #: Number of the leaflet of each triangle, shape (m,); None where they are not told apart.
    leaflet: NDArray[Any] | None


class LineArrays(NamedTuple):
    """A mesh of segments."""

    #: Points [mm], shape (n, 3).
    points_mm: NDArray[Any]
    #: Point numbers from 0, shape (m, 2).
    segments: NDArray[np.int64]
    #: Unloaded length of each segment [mm], shape (m,); None where it is not known.
    rest_length_mm: NDArray[Any] | None
    #: Cross-section of each segment [mm²], shape (m,); None where it is not known.
    area_mm2: NDArray[Any] | None


def leaflets_of(given: SurfaceArrays | Mapping[str, SurfaceArrays]) -> list[Leaflet]:
    """Leaflets of meshes by name, or of one mesh whose triangles say which they belong to."""
    if isinstance(given, Mapping):
        return [_leaflet(name, mesh, None) for name, mesh in given.items()]
    if given.leaflet is None:
        return [_leaflet("leaflet", given, None)]
    of_cell = np.asarray(given.leaflet).astype(np.int64)
    numbers = np.unique(of_cell)
    names = [NAMES[number] if 0 <= number < len(NAMES) else f"leaflet {number}" for number in numbers]
    return [_leaflet(name, given, of_cell == number) for name, number in zip(names, numbers)]


def _leaflet(name: str, mesh: SurfaceArrays, own: NDArray[np.bool_] | None) -> Leaflet:
    triangles = mesh.triangles if own is None else mesh.triangles[own]
    used, numbered = np.unique(triangles, return_inverse=True)
    marks = None
    if mesh.annulus is not None:
        on_annulus = np.asarray(mesh.annulus)[used] > 0.5
        marks = np.flatnonzero(on_annulus).astype(np.int64)
    return Leaflet(
        name,
        np.ascontiguousarray(mesh.points_mm[used], dtype=np.float64),
        np.ascontiguousarray(numbered.reshape(-1, 3).astype(np.int64)),
        annulus_points=marks,
    )


def chord_groups_of(given: Mapping[str, LineArrays]) -> list[ChordGroup]:
    """Groups of chordae of line meshes by name."""
    return [_chord_group(name, mesh) for name, mesh in given.items()]


def _chord_group(name: str, mesh: LineArrays) -> ChordGroup:
    def array(values: NDArray[Any] | None) -> FloatArray | None:
        return None if values is None else np.ascontiguousarray(values, dtype=np.float64)

    return ChordGroup(
        name,
        np.ascontiguousarray(mesh.points_mm, dtype=np.float64),
        np.ascontiguousarray(mesh.segments),
        rest_length_mm=array(mesh.rest_length_mm),
        area_mm2=array(mesh.area_mm2),
    )


def no_triangles(name: str, advice: str) -> InputError:
    """The error of a leaflet with other cells."""
    return InputError([Fault(name, f"has cells that are no triangles; expected triangles ({advice})")])


def no_segments(name: str) -> InputError:
    """The error of chordae with other cells."""
    return InputError([Fault(name, "has cells that are no segments; expected lines of two points each")])


def annulus_marks(valve: Valve) -> FloatArray:
    """1 at the leaflet vertices on the annulus, 0 at others, shape (leaflet vertices,)."""
    marks = np.zeros(valve.leaflet_vertex_count)
    marks[valve.annulus] = 1.0
    return marks


def closed_arrays(closed: Closed) -> dict[str, FloatArray]:
    """What is known at the vertices of the closed leaflets, named as in ``closed.vtp``."""
    valve = closed.valve
    count = valve.leaflet_vertex_count
    gap_mm, contact, strain = closed._native.at_points()
    return {
        "gap_mm": gap_mm,
        "contact": contact.astype(np.float64),
        "strain": strain,
        "displacement_mm": closed.positions_mm[:count] - valve.points_mm[:count],
    }
