"""To 3D Slicer's scene and from its nodes. Its modules `slicer` and `vtk` are imported when a node is asked for.

Slicer's scene is in RAS (x to the right, y anterior), coapt in LPS (x to the left, y posterior): points and vectors are turned half round
about z, here on the way out and by the scene's mark `space = "RAS"` on the way in. Files are another matter: Slicer reads and writes
them in the frame that they are marked with, as coapt does.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from coapt._arrays import FloatArray, IndexArray
from coapt._errors import Fault, InputError
from coapt._meshes import LineArrays, SurfaceArrays, annulus_marks, closed_arrays, no_segments, no_triangles
from coapt._optional import needed

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    from coapt._closed import Closed
    from coapt._valve import Valve

#: From LPS to RAS, and back.
TURN = np.array([-1.0, -1.0, 1.0])

#: Arrays that are vectors, which turn with the points.
VECTORS = ("displacement_mm",)

#: Slicer's own table, which the colour-blind can read.
COLOURS = "vtkMRMLColorTableNodeFileViridis.txt"


class ModelNode(Protocol):
    """A ``vtkMRMLModelNode`` of Slicer."""

    def GetPolyData(self) -> vtkPolyData | None: ...
    def GetParentTransformNode(self) -> object | None: ...


class MarkupsNode(Protocol):
    """A ``vtkMRMLMarkupsNode`` of Slicer: points, or a curve."""

    PositionDefined: int

    def GetNumberOfControlPoints(self) -> int: ...
    def GetNthControlPointPositionStatus(self, number: int, /) -> int: ...
    def GetNthControlPointPositionWorld(self, number: int, position: list[float], /) -> object: ...


def open_leaflets(valve: Valve) -> ModelNode:
    """The open leaflets as a node of the scene."""
    # Asked for first: who has no Slicer may have no VTK either.
    _scene()
    mesh = _surface(valve, valve.points_mm)
    return _add(f"{valve.name} open leaflets", mesh, None, _notice())


def closed_valve(closed: Closed) -> tuple[ModelNode, ModelNode | None]:
    """The closed leaflets and the chordae as nodes of the scene."""
    _scene()
    name = f"{closed.valve.name} closed"
    trust = "certified" if closed.certified else f"NOT CERTIFIED ({closed.status}): figures of such a shape are no prediction"
    description = f"{trust}; {_notice()}"
    mesh = _surface(closed.valve, closed.positions_mm)
    for key, values in closed_arrays(closed).items():
        _add_array(mesh.GetPointData(), key, values * TURN if key in VECTORS else values)
    leaflets = _add(f"{name} leaflets", mesh, "gap_mm", description)
    points_mm, segments = closed.chords
    if not len(segments):
        return leaflets, None
    lines = _polydata(points_mm)
    lines.SetLines(_cells(segments))
    _add_array(lines.GetCellData(), "group", closed.valve.chord_groups[0].astype(np.float64))
    _add_array(lines.GetCellData(), "force_n", closed.chord_forces_n)
    return leaflets, _add(f"{name} chordae", lines, "force_n", description)


def _notice() -> str:
    from coapt._certificate import NOTICE

    return NOTICE


def _scene() -> Any:
    try:
        import slicer  # type: ignore[import-not-found, unused-ignore]
    except ImportError as error:
        message = (
            "to_slicer() needs 3D Slicer: call it in Slicer's Python console, with coapt installed there; elsewhere write files with "
            "write(folder), which Slicer opens"
        )
        raise ImportError(message, name="slicer") from error
    # Before anything is made of it.
    _support("to_slicer()")
    return slicer.mrmlScene


def _surface(valve: Valve, positions_mm: FloatArray) -> vtkPolyData:
    """The leaflets in some position, in RAS."""
    mesh = _polydata(positions_mm[: valve.leaflet_vertex_count])
    # Half a turn is no reflection: normals go on pointing to the atrium.
    mesh.SetPolys(_cells(valve.triangles))
    _add_array(mesh.GetPointData(), "annulus", annulus_marks(valve))
    _add_array(mesh.GetCellData(), "leaflet", valve.triangle_leaflet.astype(np.float64))
    return mesh


def _polydata(points_mm: FloatArray) -> vtkPolyData:
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    points = vtkPoints()
    points.SetData(_support().numpy_to_vtk(points_mm * TURN, deep=True))
    mesh = vtkPolyData()
    mesh.SetPoints(points)
    return mesh


def _cells(rows: IndexArray) -> Any:
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    cells = vtkCellArray()
    cells.SetData(rows.shape[1], _support().numpy_to_vtkIdTypeArray(rows.astype(np.int64).ravel(), deep=True))
    return cells


def _add_array(attributes: Any, name: str, values: NDArray[Any]) -> None:
    array = _support().numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    attributes.AddArray(array)


def _add(name: str, mesh: vtkPolyData, coloured_by: str | None, description: str) -> ModelNode:
    """A new model node with its display; cells are coloured where it is they that have the array."""
    from vtkmodules.vtkCommonDataModel import vtkDataObject

    node = _scene().AddNewNodeByClass("vtkMRMLModelNode", name)
    node.SetDescription(description)
    node.SetAndObservePolyData(mesh)
    node.CreateDefaultDisplayNodes()
    display = node.GetDisplayNode()
    # Both sides of a leaflet are seen.
    display.SetBackfaceCulling(False)
    if coloured_by is not None:
        at_points = mesh.GetPointData().HasArray(coloured_by)
        display.SetActiveScalarName(coloured_by)
        display.SetActiveAttributeLocation(vtkDataObject.POINT if at_points else vtkDataObject.CELL)
        display.SetAndObserveColorNodeID(COLOURS)
        display.SetScalarVisibility(True)
    made: ModelNode = node
    return made


def surfaces_of(given: ModelNode | Mapping[str, ModelNode]) -> SurfaceArrays | dict[str, SurfaceArrays]:
    """Triangle meshes of model nodes [mm], RAS, where Slicer shows them."""
    if isinstance(given, Mapping):
        return {name: _surface_of(name, node) for name, node in given.items()}
    return _surface_of("leaflets", given)


def _surface_of(name: str, node: ModelNode) -> SurfaceArrays:
    mesh = _mesh_of(name, node)
    polys = mesh.GetPolys()
    others = mesh.GetNumberOfVerts() + mesh.GetNumberOfLines() + mesh.GetNumberOfStrips()
    if others or not mesh.GetNumberOfPolys() or polys.IsHomogeneous() != 3:
        raise no_triangles(name, "module Surface Toolbox, or `vtkTriangleFilter`")
    return SurfaceArrays(
        _points_of(node, mesh),
        _rows(polys, 3),
        _array_of(mesh.GetPointData(), "annulus"),
        _array_of(mesh.GetCellData(), "leaflet"),
    )


def lines_of(given: Mapping[str, ModelNode]) -> dict[str, LineArrays]:
    """Line meshes of model nodes by name [mm], RAS, where Slicer shows them."""
    return {name: _lines_of(name, node) for name, node in given.items()}


def _lines_of(name: str, node: ModelNode) -> LineArrays:
    mesh = _mesh_of(name, node)
    lines = mesh.GetLines()
    others = mesh.GetNumberOfVerts() + mesh.GetNumberOfPolys() + mesh.GetNumberOfStrips()
    if others or not mesh.GetNumberOfLines() or lines.IsHomogeneous() != 2:
        raise no_segments(name)
    cells = mesh.GetCellData()
    return LineArrays(_points_of(node, mesh), _rows(lines, 2), _array_of(cells, "rest_length_mm"), _array_of(cells, "area_mm2"))


def _mesh_of(name: str, node: ModelNode) -> vtkPolyData:
    get = getattr(node, "GetPolyData", None)
    mesh: vtkPolyData | None = None if get is None else get()
    if mesh is None or mesh.GetPoints() is None:
        raise InputError([Fault(name, f"is {_kind(node)} without a surface; expected a vtkMRMLModelNode with one")])
    return mesh


def _points_of(node: ModelNode, mesh: vtkPolyData) -> FloatArray:
    """Where Slicer shows the points: below the transforms of the node."""
    points_mm: FloatArray = _support().vtk_to_numpy(mesh.GetPoints().GetData()).astype(np.float64)
    parent: Any = node.GetParentTransformNode()
    if parent is None:
        return points_mm
    from vtkmodules.vtkCommonTransforms import vtkGeneralTransform

    to_world = vtkGeneralTransform()
    parent.GetTransformToWorld(to_world)
    return np.array([to_world.TransformPoint(*point) for point in points_mm.tolist()])


def _rows(cells: Any, columns: int) -> NDArray[np.int64]:
    rows: NDArray[np.int64] = _support().vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64).reshape(-1, columns)
    return rows


def _array_of(attributes: Any, name: str) -> NDArray[Any] | None:
    array = attributes.GetArray(name)
    values: NDArray[Any] | None = None if array is None else _support().vtk_to_numpy(array)
    return values


def marked_points(name: str, node: MarkupsNode) -> FloatArray:
    """The control points of a markups node [mm], RAS, where Slicer shows them, shape (n, 3)."""
    if not hasattr(node, "GetNthControlPointPositionWorld"):
        raise InputError([Fault(name, f"is {_kind(node)}; expected a vtkMRMLMarkupsNode")])
    points = []
    for number in range(node.GetNumberOfControlPoints()):
        if node.GetNthControlPointPositionStatus(number) != node.PositionDefined:
            raise InputError([Fault(name, f"has a control point, of number {number}, that was not placed; expected all of them placed")])
        position = [0.0, 0.0, 0.0]
        node.GetNthControlPointPositionWorld(number, position)
        points.append(position)
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def curve_points(name: str, node: MarkupsNode) -> FloatArray:
    """A curve as Slicer draws it, between its control points too [mm], RAS, shape (n, 3); of other markups the control points."""
    drawn = getattr(node, "GetCurvePointsWorld", None)
    points = None if drawn is None else drawn()
    if points is None or not points.GetNumberOfPoints():
        return marked_points(name, node)
    points_mm: FloatArray = _support().vtk_to_numpy(points.GetData()).astype(np.float64)
    # Some versions end a closed curve where it began.
    return points_mm[:-1] if len(points_mm) > 1 and np.array_equal(points_mm[0], points_mm[-1]) else points_mm


def _support(what: str = "from_slicer()") -> Any:
    """VTK's conversions, which have no types; without VTK it is told what needs it."""
    with needed("vtk", what, "vtkmodules"):
        from vtkmodules.util import numpy_support

    return numpy_support


def _kind(node: object) -> str:
    return f"a {type(node).__name__}"
