"""Valves from arrays: right ones are those of files, wrong ones are told with what was found and what was expected."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")

from hypothesis import HealthCheck, given, settings  # noqa: E402
from hypothesis import strategies as st  # noqa: E402
from hypothesis.extra import numpy as arrays  # noqa: E402


def dome(rings: int = 3, around: int = 8):
    """A single patch that hangs from a circle of 15 mm: points, triangles, points of the circle."""
    points, triangles = [[0.0, 0.0, -6.0]], []
    for ring in range(1, rings + 1):
        radius = 15.0 * ring / rings
        for step in range(around):
            angle = 2 * np.pi * (step + ring / 2) / around
            points.append([radius * np.cos(angle), radius * np.sin(angle), -6.0 * (1 - (ring / rings) ** 2)])
    for step in range(around):
        triangles.append([0, 1 + step, 1 + (step + 1) % around])
    for ring in range(1, rings):
        inner, outer = 1 + (ring - 1) * around, 1 + ring * around
        for step in range(around):
            after = (step + 1) % around
            triangles.append([inner + step, outer + step, inner + after])
            triangles.append([inner + after, outer + step, outer + after])
    circle = np.arange(1 + (rings - 1) * around, 1 + rings * around)
    return np.array(points), np.array(triangles), circle


def leaflet(**changes):
    points, triangles, circle = dome()
    return coapt.Leaflet(**{
        "name": "patch",
        "points_mm": points,
        "triangles": triangles,
        "annulus_points": circle,
        **changes,
    })


def test_a_patch_of_arrays_closes():
    closed = coapt.Valve([leaflet()]).close()
    assert closed.certified
    # Pressure lifts it above where it hung.
    assert closed.positions_mm[0, 2] > -6.0


@pytest.mark.parametrize("kind", [np.int32, np.int64, np.uint32, np.uint64])
def test_whole_numbers_of_all_usual_kinds_are_taken(kind):
    _, triangles, circle = dome()
    valve = coapt.Valve([leaflet(triangles=triangles.astype(kind), annulus_points=circle.astype(kind))])
    assert valve.triangles.shape == triangles.shape


def test_a_preset_goes_through_pyvista_and_back():
    """Through PyVista and back: the same points and triangles."""
    pyvista = pytest.importorskip("pyvista")
    valve = coapt.generate("healthy", faces=160)
    surface = valve.to_pyvista()
    assert isinstance(surface, pyvista.PolyData) and surface.n_cells == len(valve.triangles)
    again = coapt.Valve.from_pyvista(surface, name="healthy")
    assert again.leaflet_names == ("anterior", "posterior")
    assert again.points_mm[: again.leaflet_vertex_count].shape == surface.points.shape


def test_a_preset_of_arrays_closes_to_the_same_bytes():
    """Arrays and files are two doors to the same scene: all parts of a preset as arrays give its very positions."""
    valve = coapt.generate("healthy", faces=160)
    scene = json.loads(valve.__reduce__()[1][0])["scene"]
    again = coapt.Valve(
        [
            coapt.Leaflet(
                it["name"],
                np.array(it["mesh"]["points_mm"]),
                np.array(it["mesh"]["faces"]),
                np.array(it["mesh"]["annulus_points"]),
                thickness_mm=it["thickness_mm"],
                tissue=coapt.BilinearSprings(**{key: value for key, value in it["tissue"].items() if key != "law"}),
            )
            for it in scene["leaflets"]
        ],
        [
            coapt.ChordGroup(
                it["name"],
                np.array(it["mesh"]["points_mm"]),
                np.array(it["mesh"]["segments"]),
                rest_length_mm=np.array(it["mesh"]["rest_length_mm"]),
                **{key: it[key] for key in ("diameter_mm", "modulus_mpa", "rest_length_scale", "insertion_radius_mm")},
            )
            for it in scene["chordae"]
        ],
        [coapt.PapillaryMuscle(it["name"], np.array(it["tips_mm"])) for it in scene["papillary"]],
        pressure_mmhg=scene["load"]["pressure_mmhg"],
        name=scene["name"],
        contact=coapt.Contact(**scene["contact"]),
        landmarks=coapt.Landmarks(**scene["landmarks"]),
        settings=coapt.Settings(**scene["settings"]),
        weld=coapt.Weld(**scene["weld"]),
    )
    assert again.close().positions_mm.tobytes() == valve.close().positions_mm.tobytes()


def test_arrays_in_ras_are_turned():
    """All parts of a preset in RAS: x and y of other sign, of points, motions and landmarks. What comes back is LPS, to the last bit."""
    given = coapt.generate("healthy", faces=160)
    scene = json.loads(given.__reduce__()[1][0])["scene"]
    around = given.points_mm[given.annulus]

    def valve(space, turn):
        def turned(points):
            return np.ascontiguousarray(np.array(points, dtype=float).reshape(-1, 3) * turn)

        leaflets = [
            coapt.Leaflet(
                it["name"],
                turned(it["mesh"]["points_mm"]),
                np.array(it["mesh"]["faces"]),
                annulus_displacement_mm=turned(it["mesh"]["points_mm"]) * 0.01,
            )
            for it in scene["leaflets"]
        ]
        chordae = [
            coapt.ChordGroup(it["name"], turned(it["mesh"]["points_mm"]), np.array(it["mesh"]["segments"])) for it in scene["chordae"]
        ]
        papillary = [coapt.PapillaryMuscle(it["name"], turned(it["tips_mm"]), turned(it["tips_mm"]) * 0.01) for it in scene["papillary"]]
        return coapt.Valve(
            leaflets,
            chordae,
            papillary,
            annulus_mm=turned(around),
            annulus_tolerance_mm=0.5,
            landmarks=coapt.Landmarks(mid_anterior_mm=turned(around[np.argmin(around[:, 1])])[0].tolist()),
            space=space,
        )

    lps, ras = valve("LPS", [1, 1, 1]), valve("RAS", [-1, -1, 1])
    assert ras.points_mm.tobytes() == lps.points_mm.tobytes()
    assert ras.chords[0].tobytes() == lps.chords[0].tobytes()
    limited = coapt.Settings(iteration_limit=3)
    assert ras.close(settings=limited).positions_mm.tobytes() == lps.close(settings=limited).positions_mm.tobytes()


FAULTS = {
    "float32": (lambda p, t, c: {"points_mm": p.astype(np.float32)}, r"points_mm is float32 of shape \(25, 3\); expected"),
    "order": (lambda p, t, c: {"points_mm": np.asfortranarray(p)}, "not C-contiguous; expected"),
    "strided": (lambda p, t, c: {"points_mm": np.repeat(p, 2, axis=0)[::2]}, "not C-contiguous; expected"),
    "shape": (lambda p, t, c: {"points_mm": p[:, :2].copy()}, r"of shape \(25, 2\); expected .* \(n, 3\)"),
    "flat": (lambda p, t, c: {"points_mm": p.ravel()}, r"of shape \(75,\); expected"),
    "list": (lambda p, t, c: {"points_mm": p.tolist()}, "is of type list; expected a NumPy array"),
    "byte order": (lambda p, t, c: {"points_mm": p.astype(">f8")}, "expected .*float64"),
    "float triangles": (lambda p, t, c: {"triangles": t.astype(float)}, "triangles is float64 .*; expected .*int32"),
    "negative": (lambda p, t, c: {"triangles": np.where(t == 3, -1, t)}, "has -1 in row .*; expected"),
    "huge": (lambda p, t, c: {"triangles": np.where(t == 3, 2**40, t)}, "has 1099511627776 in row"),
    "missing point": (lambda p, t, c: {"triangles": np.where(t == 3, 99, t)}, "99"),
    "NaN": (lambda p, t, c: {"points_mm": np.where(p == p.max(), np.nan, p)}, "NaN.*|nan.*"),
    "infinite": (lambda p, t, c: {"points_mm": np.where(p == p.max(), np.inf, p)}, "inf"),
    "marks": (lambda p, t, c: {"annulus_points": c[:, None]}, r"annulus_points is int64 of shape \(8, 1\)"),
    "motion": (lambda p, t, c: {"annulus_displacement_mm": np.zeros((2, 3))}, "annulus_displacement_mm"),
    "thickness": (lambda p, t, c: {"thickness_mm": -1.0}, "thickness_mm"),
    "type": (lambda p, t, c: {"thickness_mm": "thick"}, 'thickness_mm is "thick"; expected a number'),
    "empty": (lambda p, t, c: {"points_mm": np.zeros((0, 3)), "triangles": np.zeros((0, 3), int)}, "leaflets"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_wrong_arrays_are_told(name):
    spoil, words = FAULTS[name]
    with pytest.raises(coapt.InputError, match=words) as caught:
        coapt.Valve([leaflet(**spoil(*dome()))])
    fault = caught.value.faults[0]
    assert fault.place and fault.message and fault.severity == "error"


def test_faults_say_found_and_expected():
    with pytest.raises(coapt.InputError) as caught:
        coapt.Ring.physio_like("28")
    (fault,) = caught.value.faults
    assert (fault.place, fault.found, fault.expected) == ("ring.size_mm", 'is "28"', "a number")
    assert isinstance(caught.value, ValueError) and str(caught.value) == 'ring.size_mm is "28"; expected a number'
    import pickle

    assert pickle.loads(pickle.dumps(caught.value)).faults == caught.value.faults


def test_all_faults_are_told_at_once():
    with pytest.raises(coapt.InputError) as caught:
        coapt.Ring(family="sadle", size_mm="28")  # type: ignore[arg-type]
    assert [fault.place for fault in caught.value.faults] == ["ring.family", "ring.size_mm"]


def test_numbers_of_numpy_are_numbers():
    ring = coapt.Ring.physio_like(np.float32(28), sutures=np.int64(14))
    assert ring.to_dict()["size_mm"] == 28


def test_curves_may_be_arrays():
    circle = dome()[0][-8:]
    ring = coapt.Ring(curve_mm=circle, closed=True)
    assert ring == coapt.Ring(curve_mm=circle.tolist(), closed=True) and hash(ring)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: coapt.Ring(curve_mm=np.zeros((4, 2))), "ring.curve_mm has shape (4, 2); expected (n, 3)"),
        (lambda: coapt.Ring(curve_mm=[[0.0, 0.0], [1.0, 1.0]]), "ring.curve_mm has shape (2, 2); expected (n, 3)"),
        (lambda: coapt.Ring(curve_mm=np.zeros(3)), "ring.curve_mm has shape (3,); expected (n, 3)"),
        (lambda: coapt.Ring(curve_mm=np.zeros((2, 2, 3))), "ring.curve_mm has shape (2, 2, 3); expected (n, 3)"),
        (
            lambda: coapt.Neochord(leaflet="anterior", length_mm=20, point_mm=np.zeros(2)),
            "neochord.point_mm has shape (2,); expected (3,)",
        ),
        (lambda: coapt.RelocatePapillary(muscle="a", by_mm=[0, 0, 0, 0]), "relocate-papillary.by_mm has shape (4,); expected (3,)"),
        # Of the right shape, or of none, it is the items that are wrong.
        (lambda: coapt.Ring(curve_mm=[[0.0, 0.0, "a"]]), "expected a number"),
        (lambda: coapt.Ring(curve_mm=[[0.0, 0.0, 0.0], [1.0, 1.0]]), "expected a list of length 3"),
    ],
)
def test_points_and_curves_of_a_wrong_shape_are_told_with_it(make, told):
    with pytest.raises(coapt.InputError) as caught:
        make()
    assert told in str(caught.value)


def test_a_wrong_shape_is_told_beside_other_faults():
    with pytest.raises(coapt.InputError) as caught:
        coapt.Ring(family="sadle", curve_mm=np.zeros((4, 2)))  # type: ignore[arg-type]
    assert {fault.place for fault in caught.value.faults} == {"ring.family", "ring.curve_mm"}
    assert any(fault.expected == "(n, 3)" for fault in caught.value.faults)


def test_curves_come_from_files(tmp_path):
    valve = coapt.generate("healthy", faces=160)
    coapt.closure(valve, coapt.Ring.physio_like(30)).write(tmp_path)
    curve = coapt.read_curve(tmp_path / "after" / "ring.vtp")
    assert curve.closed and curve.points_mm.shape[1] == 3
    ring = coapt.Ring(curve_mm=curve.points_mm, closed=curve.closed, placed=True)
    assert valve.with_repair(ring).close().certified
    with pytest.raises(coapt.InputError, match="nowhere"):
        coapt.read_curve(tmp_path / "nowhere.vtp")


def test_files_are_told_by_line(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('schema_version = 1\nname = "a"\nload = { pressure_mmgh = 100 }\n')
    with pytest.raises(coapt.InputError) as caught:
        coapt.load(scene)
    places = [fault.place for fault in caught.value.faults]
    assert any(place.startswith(f"{scene}:3") for place in places), places
    with pytest.raises(coapt.InputError, match="No such file"):
        coapt.load(tmp_path / "nowhere.toml")


def test_parameters_are_told_by_key():
    for wrong, words in [
        ({"anulus": {"transverse_mm": 40}}, "unknown key `anulus`; did you mean `annulus`"),
        ({"annulus": {"transverse_mm": 1e9}}, "transverse_mm"),
        ({"annulus": {"transverse_mm": float("nan")}}, "transverse_mm"),
        ({"faces": "many"}, "face_count_target"),
        ({"annulus": {"transverse_mm": object()}}, "expected a number, text, a list"),
    ]:
        with pytest.raises(coapt.InputError, match=words):
            coapt.generate("healthy", **wrong)
    with pytest.raises(coapt.InputError, match="did you mean `healthy`"):
        coapt.generate("helthy")


@pytest.fixture(scope="module")
def valve():
    return coapt.generate("healthy", faces=160)


A_VALVE = r'expected a coapt\.Valve, such as coapt\.generate\("healthy"\)'
A_SURFACE = r"expected a coapt\.Closed, such as valve\.close\(\), the path of a surface, or a tuple of points"
WRONG_TYPES = {
    "plan": (lambda valve: coapt.plan("dilated", [coapt.Ring.saddle(30)]), "valve is 'dilated'; " + A_VALVE),
    "closure": (lambda valve: coapt.closure("dilated"), "valve is 'dilated'; " + A_VALVE),
    "closure of a closed valve": (lambda valve: coapt.closure(valve.close()), "valve is <coapt.Closed .*; " + A_VALVE),
    "export": (lambda valve: coapt.export("x", "out.inp", format="calculix"), "valve is 'x'; " + A_VALVE),
    "personalise": (lambda valve: coapt.personalise("x", "out.vtp"), "valve is 'x'; " + A_VALVE),
    "close_many": (lambda valve: coapt.close_many([valve, "dilated"]), r"valves\[1\] is 'dilated'; " + A_VALVE),
    "close_many of text": (lambda valve: coapt.close_many("dilated"), "valves is 'dilated'; expected valves, such as"),
    "close_many of one": (lambda valve: coapt.close_many(valve), "valves is <coapt.Valve 'healthy'.*; expected valves, such as"),
    "study": (lambda valve: coapt.study(["healthy"]), r"valve\[0\] is 'healthy'; " + A_VALVE),
    "study of a number": (lambda valve: coapt.study(3), "valve is 3; expected valves, such as"),
    "study of no list": (lambda valve: coapt.study("healthy", faces=160), "faces is 160; expected a sequence of mesh sizes"),
    "study against a name": (lambda valve: coapt.study(valve, reference="healthy"), "reference is 'healthy'; " + A_VALVE),
    "result": (lambda valve: coapt.compare(valve, "out.vtp"), "result is <coapt.Valve .*; " + A_SURFACE),
    "reference": (lambda valve: coapt.compare("out.vtp", valve), "reference is <coapt.Valve .*; " + A_SURFACE),
    "closed_surface": (lambda valve: coapt.personalise(valve, valve), "closed_surface is <coapt.Valve .*; " + A_SURFACE),
    "surface of three": (lambda valve: coapt.compare((1, 2, 3), "out.vtp"), r"result is \(1, 2, 3\); " + A_SURFACE),
    "array": (lambda valve: coapt.compare(np.zeros((99, 3)), "out.vtp"), r"result is array\(\[\[0\., 0\., .*; " + A_SURFACE),
    "one repair": (
        lambda valve: coapt.plan(valve, coapt.Ring.saddle(30)),
        r"alternatives is Ring\(.*; expected .* such as \[coapt\.Ring\.physio_like\(30\)\]",
    ),
    "live": (lambda valve: coapt.Live(valve), r"closed is <coapt.Valve .*; expected a coapt\.Closed, such as valve\.close\(\)"),
    "max_alternatives": (
        lambda valve: coapt.plan(valve, [coapt.Ring.saddle(30)], max_alternatives="many"),
        "max_alternatives is 'many'; expected a whole number from 1",
    ),
}


@pytest.mark.parametrize("name", WRONG_TYPES)
def test_arguments_of_a_wrong_type_are_told_by_name(name, valve):
    work, words = WRONG_TYPES[name]
    with pytest.raises(TypeError, match=f"^{words}"):
        work(valve)


SIZE = "expected a whole number from 100 to 1000000"
WRONG_STUDIES = {
    "no valve": (lambda valve: ([], {}), ["valve is an empty sequence; expected a preset, a valve, or at least one valve"]),
    "repeats": (lambda valve: (valve, {"repeats": 0}), ["repeats is 0; expected a whole number from 1 to 1000"]),
    "repeats of laws": (
        lambda valve: (valve, {"laws": True, "repeats": -1}),
        ["repeats is -1; expected a whole number from 1 to 1000"],
    ),
    "settings": (
        lambda valve: (valve, {"tolerances": [0.1, -1], "thicknesses_mm": [0, 9]}),
        [
            "tolerances[1] is -1; expected a number above 0 and below 1",
            "thicknesses_mm[0] is 0; expected a number of mm above 0, at most 5",
            "thicknesses_mm[1] is 9; expected a number of mm above 0, at most 5",
        ],
    ),
    "no tolerance": (lambda valve: (valve, {"tolerances": []}), ["tolerances is empty; expected at least one residual"]),
    "no size": (lambda valve: ("healthy", {"faces": []}), ["faces is empty; expected at least one mesh size, in triangles"]),
    "sizes": (
        lambda valve: ("healthy", {"faces": [-1, 160], "reference_faces": 0, "laws": True}),
        [f"faces[0] is -1; {SIZE}", f"reference_faces is 0; {SIZE}"],
    ),
    "coarse reference": (
        lambda valve: ("healthy", {"faces": [150, 300], "reference_faces": 200}),
        ["reference_faces is 200, coarser than the finest mesh studied; expected at least 300"],
    ),
    "sizes of a valve": (
        lambda valve: (valve, {"faces": [2600], "reference_faces": 5200}),
        [
            "faces is [2600], which is for presets; expected none: any other valve has the mesh that it has",
            "reference_faces is 5200, which is for presets; expected none: any other valve has the mesh that it has",
        ],
    ),
    "reference of a preset": (
        lambda valve: ("healthy", {"reference": valve}),
        [
            "reference is <coapt.Valve 'healthy': 170 triangles, 100 mmHg>, which is for valves; "
            "expected none beside a preset, but reference_faces"
        ],
    ),
}


@pytest.mark.parametrize("name", WRONG_STUDIES)
def test_wrong_studies_are_refused_as_by_the_program(name, valve):
    make, words = WRONG_STUDIES[name]
    given, keywords = make(valve)
    with pytest.raises(coapt.InputError) as caught:
        coapt.study(given, **keywords)
    assert [str(fault) for fault in caught.value.faults] == words


@pytest.mark.parametrize("alternatives", [[], {}, [[]]])
def test_plans_without_a_repair_are_refused(valve, alternatives):
    with pytest.raises(coapt.InputError):
        coapt.plan(valve, alternatives)


def test_too_many_alternatives_are_told_in_the_words_of_the_package(valve):
    rings = [coapt.Ring.physio_like(size) for size in (28, 30, 32)]
    with pytest.raises(coapt.InputError, match=r"^plan has 3 alternatives.*expected 2 at most \(max_alternatives\)$"):
        coapt.plan(valve, rings, max_alternatives=2)
    for wrong in (-1, 0):
        with pytest.raises(ValueError, match=f"^max_alternatives is {wrong}; expected a whole number from 1$"):
            coapt.plan(valve, rings, max_alternatives=wrong)


def test_one_is_not_many(valve):
    ring = coapt.Ring.physio_like(30)
    done = coapt.plan(valve, [ring], max_alternatives=np.int64(1))
    assert repr(done) == "<coapt.PlanResult of 1 alternative>"
    assert repr(valve.with_repair(ring)).endswith(", 1 repair>")
    study = coapt.study(valve, tolerances=[1e-2], thicknesses_mm=[], repeats=1)
    assert repr(study) == "<coapt.StudyResult of 1 closure>"


def test_plans_of_python_values_name_no_lines(valve, tmp_path):
    """What nobody has written in a file has no line: neither doubts about the plan nor why an alternative cannot be carried out."""
    ring = coapt.Ring.physio_like(30)
    # The healthy valve has no cleft there.
    told = coapt.plan(valve, [ring, ring, coapt.CloseCleft(position=0.35, depth_mm=1.0)]).to_dict()
    of_rows = [words for row in told["alternatives"] for words in row["warnings"] + row["faults"]]
    assert any("closed once" in words for words in told["warnings"]) and of_rows
    assert all(words.startswith("plan: ") for words in told["warnings"] + of_rows), (told["warnings"], of_rows)
    # Of a file it is told.
    file = tmp_path / "plan.toml"
    block = '[[alternative]]\n[[alternative.repair]]\nkind = "ring"\nfamily = "physio-like"\nsize_mm = 30\n'
    file.write_text("schema_version = 1\n" + 2 * block)
    assert coapt.plan(valve, file).to_dict()["warnings"][0].startswith(f"{file}:8: ")


ANY_ARRAY = arrays.arrays(
    dtype=st.one_of(
        arrays.floating_dtypes(), arrays.integer_dtypes(), arrays.boolean_dtypes(), arrays.unicode_string_dtypes(max_len=3)
    ),
    shape=arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6),
)


# Most are refused at the door, in microseconds; a slow machine must not fail for its slowness.
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(points=ANY_ARRAY, triangles=ANY_ARRAY)
def test_no_array_brings_it_down(points, triangles):
    try:
        coapt.Valve([coapt.Leaflet("any", points, triangles)])
    except coapt.InputError as error:
        assert error.faults and all(fault.place and fault.message for fault in error.faults)


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    moved=arrays.arrays(np.float64, (25, 3), elements=st.floats(-3, 3)),
    which=st.integers(0, 24),
)
def test_no_shape_brings_it_down(moved, which):
    """Whatever shape: refused in words, or closed with a status and finite positions."""
    points, _, _ = dome()
    try:
        valve = coapt.Valve([leaflet(points_mm=points + moved * (np.arange(25) >= which)[:, None])])
    except coapt.InputError as error:
        assert error.faults
        return
    closed = valve.close(settings=coapt.Settings(iteration_limit=30))
    assert np.isfinite(closed.positions_mm).all()


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (lambda valve: valve.close(settings=3), "settings is 3; expected a coapt.Settings"),
        (lambda valve: valve.close(start=3), "start is 3; expected a coapt.Closed"),
        (lambda valve: valve.close(pressure_mmhg="100"), "pressure_mmhg is '100'; expected a number [mmHg]"),
        (lambda valve: valve.with_pressure(None), "pressure_mmhg is None; expected a number [mmHg]"),
        (lambda valve: valve.with_settings(None), "settings is None; expected a coapt.Settings"),
        (lambda valve: valve.with_contact(0.5), "contact is 0.5; expected a coapt.Contact"),
        (lambda valve: coapt.Valve([3]), "leaflets[0] is 3; expected a coapt.Leaflet"),
        (lambda valve: coapt.Valve(3), "leaflets is 3; expected a sequence"),
    ],
)
def test_arguments_of_a_wrong_type_are_told_by_name(wrong, told):
    with pytest.raises(TypeError, match="^" + re.escape(told)):
        wrong(coapt.generate("healthy", faces=160))
