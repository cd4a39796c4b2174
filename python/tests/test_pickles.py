"""Everything that a user is given survives a pickle: what it tells, what it holds, what it writes."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")

from test_plain_data import ONE_OF_EACH  # noqa: E402

FACES = 160


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> dict[str, object]:
    """One of each class that is made by calling something, by its name."""
    folder = tmp_path_factory.mktemp("made")
    valve = coapt.generate("healthy", faces=FACES)
    repaired = valve.with_repair(coapt.Clip(site="A2P2"))
    closure = coapt.closure(valve, coapt.Clip(site="A2P2"), coapt.Ring.physio_like(30))
    asked = {
        "repair": [{"kind": "ring", "family": "physio-like", "size_mm": [28, 34]}],
        "diastole": True,
        "sensitivities": True,
        "uncertainty": {"samples": 2, "seed": 7, "alternatives": 1},
        "search": {"repair": 0, "key": "size_mm", "from": 36, "to": 34, "tolerance": 1, "measure": "coaptation/area_mm2",
                   "at_least": 1.0},
    }
    table = folder / "biaxial.csv"
    table.write_text(BIAXIAL)
    point_list = folder / "ring.mrk.json"
    point_list.write_text(MARKUPS)
    film = folder / "closing.mcap"
    closure.before.record(film, frames=2)
    fault = coapt.Fault("scene.toml:3", "is 3; expected 4")
    return {
        "Valve": repaired,
        "Closed": closure.after,
        "Closure": closure,
        "PlanResult": coapt.plan(valve, asked, keep_shapes=True),
        "StudyResult": coapt.study(valve, tolerances=(1e-2,), thicknesses_mm=(), repeats=1),
        "LawStudyResult": coapt.study(valve, laws=True, repeats=1),
        "Comparison": coapt.compare(closure.after, closure.before),
        "FitResult": coapt.personalise(valve, valve.close(pressure_mmhg=110)),
        "CheckResult": coapt.check(valve),
        "SpringQuality": coapt.check(valve).springs[0],
        "TissueFit": coapt.fit_tissue(table),
        "FileCurve": coapt.read_curve(point_list),
        "ReplayResult": coapt.replay(film),
        "FrameDifference": coapt.FrameDifference("/valve", 3, "lies elsewhere", 7, 1.5e-9),
        "Certificate": closure.after.certificate,
        "Iteration": closure.after.history[0],
        "Fault": fault,
        "InputError": coapt.InputError([fault, coapt.Fault("b", "c", "warning")]),
    }


#: Equibiaxial, of a tissue that stiffens.
BIAXIAL = "stretch_circ,stretch_rad,cauchy_stress_circ_kpa,cauchy_stress_rad_kpa\n" + "".join(
    f"{stretch},{stretch},{stress},{stress}\n"
    for stretch, stress in [(1.0, 0), (1.05, 4), (1.1, 8), (1.15, 12), (1.2, 20), (1.25, 40), (1.3, 70), (1.33, 95)]
)

MARKUPS = """{"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
"markups": [{"type": "ClosedCurve", "coordinateSystem": "LPS", "coordinateUnits": "mm", "controlPoints": [
{"position": [10.0, 0.0, 0.0]}, {"position": [0.0, 10.0, 0.0]}, {"position": [-10.0, 0.0, 1.0]}, {"position": [0.0, -10.0, 0.0]}]}]}"""


def again(it):
    return pickle.loads(pickle.dumps(it))


def same(one: object, other: object) -> bool:
    """Whether two values are the same through and through, arrays by their bytes."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.flags.writeable == other.flags.writeable, "one can be written to"
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other))
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
    if isinstance(one, BaseException):
        return same(vars(one), vars(other)) and str(one) == str(other)
    if dataclasses.is_dataclass(one):
        return all(same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one))
    if type(one).__module__.startswith("coapt"):
        return all(same(*pair) for pair in zip(told(one), told(other), strict=True))
    return one == other


#: Nothing of these is the result's own, or they are told by other properties and only take time.
LEFT_OUT = {"measures", "valve", "before", "after"}


def told(it: object) -> list[object]:
    """All that a result tells: its properties, its texts."""
    names = [name for name, member in inspect.getmembers(type(it)) if isinstance(member, property)]
    values = [getattr(it, name) for name in names if name not in LEFT_OUT]
    calls = [getattr(it, name) for name in ("text", "to_dict", "_repr_svg_", "_repr_html_") if hasattr(it, name)]
    return [repr(it), *values, *(call() for call in calls)]


BRANCHES = coapt.SpringBranches(pre_transition_modulus_mpa=0.1, transition_strain=0.1, post_transition_modulus_mpa=4.0)

#: What is made by calling its class alone, and what holds nothing.
PLAIN = [
    *ONE_OF_EACH,
    coapt.Ring(curve_mm=np.array([[10.0, 0, 0], [0, 10, 0], [-10, 0, 0]]), closed=True),
    coapt.Settings(iteration_limit=3),
    coapt.Contact(thickness_mm=0.4),
    coapt.Landmarks(),
    coapt.Weld(tolerance_mm=0.1),
    coapt.BilinearSprings(),
    BRANCHES,
    coapt.AnisotropicSprings(circumferential=BRANCHES, radial=BRANCHES.replace(transition_strain=0.3)),
    coapt.StVenantKirchhoff(modulus_mpa=0.4),
    coapt.Exponential(c0_mpa=0.001, c1_mpa=0.0001, c2=4.5),
    coapt.MayNewman(c0_mpa=0.0003, c1=8.0, c2=1400.0),
    coapt.ChordLinear(modulus_mpa=30.0),
]


@pytest.mark.parametrize("it", PLAIN, ids=lambda it: type(it).__name__)
def test_plain_data_survives(it):
    assert again(it) == it and hash(again(it)) == hash(it)


RESULTS = [
    "Valve", "Closed", "Closure", "PlanResult", "StudyResult", "LawStudyResult", "Comparison", "FitResult", "CheckResult",
    "SpringQuality", "TissueFit", "FileCurve", "ReplayResult", "FrameDifference", "Certificate", "Iteration", "Fault", "InputError",
]  # fmt: skip


@pytest.mark.parametrize("name", RESULTS)
def test_results_survive(made, name):
    it = made[name]
    assert type(it) is getattr(coapt, name)
    assert same(again(it), it)
    assert same(copy.deepcopy(it), it)


def test_no_class_is_forgotten(made):
    """Of the classes that are left out, measures are dataclasses of numbers, told by the results above; a Live refuses."""
    covered = {type(it) for it in [*made.values(), *PLAIN]}
    measures = {kind for kind in vars(coapt).values() if inspect.isclass(kind) and kind.__module__ == "coapt._measures"}
    others = {coapt.Live, coapt.ChordScale, coapt.TargetDistance, coapt.Leaflet, coapt.ChordGroup, coapt.PapillaryMuscle}
    laws = {coapt.ChordPiecewiseLinear, coapt.ChordExponential, coapt.ChordCollagen, coapt.ChordTable}
    public = {kind for name in coapt.__all__ if inspect.isclass(kind := getattr(coapt, name))}
    assert public == covered | measures | others | laws
    assert same(again(made["Closed"].measures), made["Closed"].measures)


WRITTEN = ["Closed", "Closure", "PlanResult", "StudyResult", "LawStudyResult", "Comparison"]


@pytest.mark.parametrize("name", WRITTEN)
def test_pickled_results_write_the_same_bytes(made, name, tmp_path):
    made[name].write(tmp_path / "before")
    again(made[name]).write(tmp_path / "after")
    files = sorted(path.relative_to(tmp_path / "before") for path in (tmp_path / "before").rglob("*.*"))
    assert files and files == sorted(path.relative_to(tmp_path / "after") for path in (tmp_path / "after").rglob("*.*"))
    for file in files:
        assert (tmp_path / "before" / file).read_bytes() == (tmp_path / "after" / file).read_bytes(), file


def test_a_pickled_plan_makes_the_same_page(made, tmp_path):
    made["PlanResult"].report(tmp_path / "before.html")
    again(made["PlanResult"]).report(tmp_path / "after.html")
    assert (tmp_path / "before.html").read_bytes() == (tmp_path / "after.html").read_bytes()


def test_a_pickled_fit_closes_to_the_same_shapes(made):
    fit, back = made["FitResult"], again(made["FitResult"])
    for one, other in ((fit.before, back.before), (fit.after, back.after)):
        assert one.positions_mm.tobytes() == other.positions_mm.tobytes()
    assert fit.valve.points_mm.tobytes() == back.valve.points_mm.tobytes()


def test_what_did_not_close_survives():
    """A valve that burst leaves numbers that are none."""
    valve = coapt.generate("healthy", faces=FACES).with_settings(coapt.Settings(iteration_limit=2))
    plan = coapt.plan(valve, [coapt.Ring.physio_like(30), coapt.Clip(site="A2P2")])
    assert not plan.certified and same(again(plan), plan)
    laws = coapt.study(valve, laws=True, repeats=1)
    assert not any(row["certified"] for row in laws.rows) and same(again(laws), laws)


@pytest.mark.parametrize("name", ["PlanResult", "StudyResult", "LawStudyResult", "Comparison", "FitResult"])
def test_pickles_of_other_versions_are_refused(made, name):
    rebuild, (stored,) = made[name].__reduce__()
    at = stored.index(b"-result/1")
    with pytest.raises(coapt.InputError, match="-result/9`; this version reads `coapt-.*-result/1`"):
        rebuild(stored[:at] + b"-result/9" + stored[at + 9 :])
    for spoilt in (b"", b"nonsense", stored[:-7]):
        with pytest.raises(coapt.InputError, match="pickle"):
            rebuild(spoilt)


@pytest.mark.parametrize("name", ["Certificate", "Closure", "Iteration"])
def test_pickles_of_before_a_module_was_parted_are_read(made, name):
    """Their classes were `coapt._closed.…`."""
    it = made[name]
    stored = pickle.dumps(it, protocol=0)
    there = f"{type(it).__module__}\n{name}".encode()
    assert stored.count(there) == 1
    assert same(pickle.loads(stored.replace(there, f"coapt._closed\n{name}".encode())), it)
