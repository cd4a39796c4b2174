"""3D Slicer, played by a small scene of its calls with VTK's own meshes: what goes into the scene, and valves of what lies in it."""

from __future__ import annotations

import subprocess
import sys
import types

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")
pytest.importorskip("vtkmodules")

from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData  # noqa: E402
from vtkmodules.vtkCommonTransforms import vtkTransform  # noqa: E402
from vtkmodules.vtkFiltersSources import vtkPlaneSource  # noqa: E402

RAS = np.array([-1.0, -1.0, 1.0])


class DisplayNode:
    def SetBackfaceCulling(self, culled: bool) -> None:
        self.culled = culled

    def SetActiveScalarName(self, name: str) -> None:
        self.scalar = name

    def SetActiveAttributeLocation(self, location: int) -> None:
        self.location = location

    def SetAndObserveColorNodeID(self, colours: str) -> None:
        self.colours = colours

    def SetScalarVisibility(self, visible: bool) -> None:
        self.visible = visible


class TransformNode:
    """A linear transform above other nodes."""

    def __init__(self) -> None:
        self.transform = vtkTransform()
        self.transform.RotateWXYZ(30.0, 1.0, 2.0, 3.0)
        self.transform.Translate(5.0, -7.0, 11.0)

    def GetTransformToWorld(self, to_world) -> None:
        to_world.Concatenate(self.transform)


class ModelNode:
    def __init__(self, mesh: vtkPolyData | None = None, parent: TransformNode | None = None) -> None:
        self.mesh, self.parent, self.display = mesh, parent, None

    def SetDescription(self, description: str) -> None:
        self.description = description

    def SetAndObservePolyData(self, mesh: vtkPolyData) -> None:
        self.mesh = mesh

    def GetPolyData(self) -> vtkPolyData | None:
        return self.mesh

    def CreateDefaultDisplayNodes(self) -> None:
        self.display = DisplayNode()

    def GetDisplayNode(self) -> DisplayNode | None:
        return self.display

    def GetParentTransformNode(self) -> TransformNode | None:
        return self.parent


class PointListNode:
    """Control points; Slicer fills the list that it is given."""

    PositionUndefined, PositionDefined = 0, 2

    def __init__(self, points, placed: bool = True) -> None:
        self.points, self.placed = np.asarray(points), placed

    def GetNumberOfControlPoints(self) -> int:
        return len(self.points)

    def GetNthControlPointPositionStatus(self, number: int) -> int:
        return self.PositionDefined if self.placed else self.PositionUndefined

    def GetNthControlPointPositionWorld(self, number: int, position: list[float]) -> int:
        position[:] = self.points[number].tolist()
        return 1


class ClosedCurveNode(PointListNode):
    """A curve of few control points, drawn through many, the first once more at its end."""

    def __init__(self, drawn) -> None:
        super().__init__(drawn[:1])
        self.drawn = vtkPoints()
        self.drawn.SetDataTypeToDouble()
        for point in [*drawn, drawn[0]]:
            self.drawn.InsertNextPoint(point)

    def GetCurvePointsWorld(self) -> vtkPoints:
        return self.drawn


class Scene:
    def __init__(self) -> None:
        self.nodes: list[tuple[str, ModelNode]] = []

    def AddNewNodeByClass(self, kind: str, name: str) -> ModelNode:
        assert kind == "vtkMRMLModelNode"
        self.nodes.append((name, ModelNode()))
        return self.nodes[-1][1]


@pytest.fixture
def scene(monkeypatch) -> Scene:
    slicer = types.ModuleType("slicer")
    slicer.mrmlScene = Scene()  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "slicer", slicer)
    return slicer.mrmlScene


@pytest.fixture(scope="module")
def closed():
    return coapt.generate("healthy", faces=160).close()


def array(attributes, name: str) -> np.ndarray:
    return vtk_to_numpy(attributes.GetArray(name))


def test_a_closed_valve_comes_into_the_scene_in_its_frame(scene, closed):
    leaflets, chordae = closed.to_slicer()
    assert [(name, node) for name, node in scene.nodes] == [
        ("healthy closed leaflets", leaflets),
        ("healthy closed chordae", chordae),
    ]
    count = closed.valve.leaflet_vertex_count
    mesh = leaflets.GetPolyData()
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    # Exact: signs alone are changed.
    assert np.array_equal(points, closed.positions_mm[:count] * RAS)
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    assert np.array_equal(triangles, closed.triangles)
    known = mesh.GetPointData()
    assert np.array_equal(array(known, "gap_mm"), closed.gap_mm)
    assert np.array_equal(array(known, "strain"), closed.strain)
    assert np.array_equal(array(known, "contact") > 0.5, closed.in_contact)
    assert np.flatnonzero(array(known, "annulus")).tolist() == sorted(closed.valve.annulus)
    # A vector turns as its ends do.
    opened = closed.valve.points_mm[:count] * RAS
    assert np.allclose(opened + array(known, "displacement_mm"), points, rtol=0, atol=1e-12)
    assert np.array_equal(array(mesh.GetCellData(), "leaflet"), closed.valve.triangle_leaflet)
    ends, segments = closed.chords
    lines = chordae.GetPolyData()
    assert np.array_equal(vtk_to_numpy(lines.GetPoints().GetData()), ends * RAS)
    assert np.array_equal(vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2), segments)
    assert np.array_equal(array(lines.GetCellData(), "force_n"), closed.chord_forces_n)
    assert np.array_equal(array(lines.GetCellData(), "group"), closed.valve.chord_groups[0])


def test_nodes_are_displayed_and_say_what_they_are(scene, closed):
    for node, name, location in zip(closed.to_slicer(), ("gap_mm", "force_n"), (vtkDataObject.POINT, vtkDataObject.CELL)):
        display = node.GetDisplayNode()
        assert (display.scalar, display.location, display.visible, display.culled) == (name, location, True, False)
        assert node.description == f"certified; {coapt.NOTICE}"
    burst = closed.valve.close(settings=coapt.Settings(iteration_limit=2))
    assert burst.to_slicer()[0].description.startswith("NOT CERTIFIED (iteration-limit)")
    assert closed.valve.to_slicer().description == coapt.NOTICE
    alone = coapt.Valve([coapt.Leaflet("patch", closed.valve.points_mm[:closed.valve.leaflet_vertex_count].copy(), closed.triangles)])
    assert alone.close(settings=coapt.Settings(iteration_limit=1)).to_slicer()[1] is None


def moved(points: np.ndarray, parent: TransformNode | None) -> np.ndarray:
    """Points of Slicer's world as they are stored below a transform."""
    if parent is None:
        return points
    inverse = parent.transform.GetLinearInverse()
    return np.array([inverse.TransformPoint(*point) for point in points])


@pytest.mark.parametrize("parent", [None, TransformNode()], ids=["in the world", "below a transform"])
def test_a_valve_of_nodes_is_the_valve_of_the_same_arrays(scene, closed, parent):
    """A preset as nodes in RAS is the preset as arrays in LPS: leaflets, chordae and tips."""
    valve = closed.valve
    model = valve.to_slicer()
    mesh = model.GetPolyData()
    for number, point in enumerate(moved(vtk_to_numpy(mesh.GetPoints().GetData()).copy(), parent)):
        mesh.GetPoints().SetPoint(number, point)
    ends, segments = valve.chords
    groups, names = valve.chord_groups
    lines = closed.to_slicer()[1].GetPolyData()
    for number, point in enumerate(moved(ends * RAS, parent)):
        lines.GetPoints().SetPoint(number, point)
    tips = ends[np.setdiff1d(segments[:, 0], segments[:, 1])]
    made = coapt.Valve.from_slicer(
        ModelNode(mesh, parent),
        {"all": ModelNode(lines, parent)},
        {"both": PointListNode(tips * RAS)},
        pressure_mmhg=110,
        name="again",
    )
    same = coapt.Valve(
        [
            coapt.Leaflet(name, valve.points_mm[used].copy(), numbered.reshape(-1, 3), annulus_points=marks)
            for name, used, numbered, marks in leaflets(valve)
        ],
        [coapt.ChordGroup("all", np.ascontiguousarray(ends), segments)],
        [coapt.PapillaryMuscle("both", np.ascontiguousarray(tips))],
        pressure_mmhg=110,
    )
    assert (made.name, made.pressure_mmhg) == ("again", same.pressure_mmhg)
    assert made.leaflet_names == ("anterior", "posterior")
    assert np.array_equal(made.triangles, same.triangles) and np.array_equal(made.annulus, same.annulus)
    assert len(made.chords[1]) == len(segments)
    # Of signs alone nothing is lost; a transform there and back rounds.
    assert np.allclose(made.points_mm, same.points_mm, rtol=0, atol=0 if parent is None else 1e-12)


def leaflets(valve):
    for number, name in enumerate(valve.leaflet_names):
        own = valve.triangles[valve.triangle_leaflet == number]
        used, numbered = np.unique(own, return_inverse=True)
        yield name, used, numbered.astype(np.int64), np.flatnonzero(np.isin(used, valve.annulus))


def test_an_annulus_is_a_curve_as_drawn_or_points(scene, closed):
    valve = closed.valve
    mesh = valve.to_slicer().GetPolyData()
    mesh.GetPointData().RemoveArray("annulus")
    around = valve.points_mm[valve.annulus] * RAS
    for node in (ClosedCurveNode(around), PointListNode(around)):
        made = coapt.Valve.from_slicer(ModelNode(mesh), annulus=node, annulus_tolerance_mm=0.5)
        assert sorted(map(tuple, made.points_mm[made.annulus])) == sorted(map(tuple, valve.points_mm[valve.annulus]))


def test_wrong_nodes_are_told(scene, closed):
    model = closed.valve.to_slicer()
    chordae = closed.to_slicer()[1]
    quad = vtkPlaneSource()
    quad.Update()
    for wrong, words in (
        (ModelNode(None), "leaflets is a ModelNode without a surface; expected a vtkMRMLModelNode"),
        (ModelNode(vtkPolyData()), "without a surface"),
        (PointListNode([]), "leaflets is a PointListNode without a surface"),
        (chordae, "leaflets has cells that are no triangles; expected triangles"),
        (ModelNode(quad.GetOutput()), "no triangles"),
    ):
        with pytest.raises(coapt.InputError, match=words):
            coapt.Valve.from_slicer(wrong)
    with pytest.raises(coapt.InputError, match="anterior has cells that are no triangles"):
        coapt.Valve.from_slicer({"anterior": chordae})
    with pytest.raises(coapt.InputError, match="marginal has cells that are no segments"):
        coapt.Valve.from_slicer(model, {"marginal": model})
    with pytest.raises(coapt.InputError, match="tips is a ModelNode; expected a vtkMRMLMarkupsNode"):
        coapt.Valve.from_slicer(model, papillary={"tips": model})
    with pytest.raises(coapt.InputError, match="tips has a control point, of number 0, that was not placed"):
        coapt.Valve.from_slicer(model, papillary={"tips": PointListNode([[0.0, 0.0, 0.0]], placed=False)})


def test_without_slicer_it_is_said_and_nothing_of_it_is_imported_unasked():
    code = (
        "import sys, coapt\n"
        "closed = coapt.generate('healthy', faces=160).close()\n"
        "print([name for name in ('slicer', 'vtk', 'vtkmodules', 'coapt._slicer') if name in sys.modules])\n"
        "for it in (closed, closed.valve):\n"
        "    try:\n"
        "        it.to_slicer()\n"
        "    except ImportError as error:\n"
        "        print(error.name, error)\n"
    )
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    imported, *told = done.stdout.splitlines()
    assert imported == "[]" and len(told) == 2
    assert all(line.startswith("slicer to_slicer() needs 3D Slicer") for line in told)


def test_without_vtk_it_is_said_what_needs_it(scene, closed, monkeypatch):
    model = coapt.Valve.to_slicer(closed.valve)
    # A module of None is one that is not there.
    monkeypatch.setitem(sys.modules, "vtkmodules.util", None)
    monkeypatch.setitem(sys.modules, "vtkmodules", None)
    for work, name in (
        (closed.to_slicer, "to_slicer"),
        (closed.valve.to_slicer, "to_slicer"),
        (lambda: coapt.Valve.from_slicer(model), "from_slicer"),
    ):
        with pytest.raises(ModuleNotFoundError, match=rf"^{name}\(\) needs vtk: pip install vtk$"):
            work()
