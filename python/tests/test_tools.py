"""Tests of `python/tools/tables_to_scene.py` and what it stands on. The pictures have `test_pictures.py`."""

from __future__ import annotations

import math
import os
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python" / "tools"))

import spring_fit  # noqa: E402
from scene_files import Case, Leaflet, Point, muscles, orient_to_atrium  # noqa: E402
from tables import InputFault  # noqa: E402
from tables_to_scene import main  # noqa: E402
from texas_trivalve import texas_case  # noqa: E402

SHARED = Path(os.environ.get("COAPT_SHARED", ROOT.parent / "shared"))
needs_shared = pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="skipped: ../shared not present")

# A square tube: annulus 0-3 at z = 0, margin 4-7 below, a chord from 4 and 5 over branch node 8 to tip 9.
# Leaflet `front` has two quads that face the lumen; `back` is wound the other way round.
NODES = """id,bc,annulus,dx_mm,dy_mm,dz_mm,x0_mm,y0_mm,z0_mm
0,annulus,1,0.1,0.2,0.3,10.1,10,0
1,annulus,1,,,,-10,10,0
2,annulus,1,0,0,0,-10,-10,0
3,annulus,1,0,0,0,10,-10,0
4,,0,,,,10,10,-8
5,,0,,,,-10,10,-8
6,,0,,,,-10,-10,-8
7,,0,,,,10,-10,-8
8,,0,,,,0,10,-15
9,papillary,0,0,0,-1.5,0.30000000000000004,10,-25
"""
FACES = "a,b,c,d,leaflet\n0,1,5,4,front\n1,2,6,5,front\n3,2,6,7,back\n0,3,7,4,back\n"
CHORDS = "a,b,group,area_mm2,rest_mm\n4,8,marginal,0.4,13.5\n5,8,marginal,0.4,13.5\n8,9,root,0.9,10.25\n"


def write_tables(folder: Path, nodes: str = NODES, faces: str = FACES, chords: str = CHORDS) -> list[str]:
    """Writes the three tables; returns the arguments that name them."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("nodes.csv", nodes), ("faces.csv", faces), ("chords.csv", chords)):
        (folder / name).write_text(text, encoding="utf-8")
    tables = [f"--{name}={folder / name}.csv" for name in ("nodes", "faces", "chords")]
    return [*tables, "--pressure-mmhg=100"]


def vtp_numbers(path: Path, place: str, name: str) -> list[float]:
    """The numbers of an ASCII array, by a reader that is not the tools' own."""
    piece = ElementTree.parse(path).getroot().find("PolyData/Piece")
    (array,) = (array for array in piece.find(place) if array.get("Name") == name)
    return [float(word) for word in array.text.split()]


def read_toml(path: Path) -> dict:
    """The scene file as a dictionary."""
    return pytest.importorskip("tomllib", reason="Python 3.11 reads TOML").loads(
        path.read_text(encoding="utf-8")
    )


# ---------------------------------------------------------------- the scene folder


def test_scene_says_what_the_tables_say(tmp_path):
    assert main(["tables", str(tmp_path / "out"), *write_tables(tmp_path), "--chord-modulus-mpa=40"]) == 0
    scene = read_toml(tmp_path / "out" / "scene.toml")
    assert scene["schema_version"] == 1
    assert scene["load"] == {"pressure_mmhg": 100.0}
    assert scene["annulus"] == {"marker_array": "annulus", "displacement_array": "annulus_displacement_mm"}
    assert [leaflet["mesh_file"] for leaflet in scene["leaflets"]] == [
        "leaflet_front.vtp",
        "leaflet_back.vtp",
    ]
    assert scene["papillary"] == [
        {
            "name": "papillary_1",
            "tips_mm": [[0.30000000000000004, 10.0, -25.0]],
            "displacements_mm": [[0.0, 0.0, -1.5]],
        }
    ]
    marginal, root = scene["chordae"]
    assert marginal == {"name": "marginal", "mesh_file": "chords_marginal.vtp", "modulus_mpa": 40.0}
    assert root["name"] == "root"
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [
        "chords_marginal.vtp",
        "chords_root.vtp",
        "leaflet_back.vtp",
        "leaflet_front.vtp",
        "scene.toml",
    ]


def test_the_library_knows_every_key_that_is_written(tmp_path):
    """The scene's types refuse unknown keys, so each key must be a field there."""
    files = sorted((ROOT / "crates" / "coapt" / "src" / "scene").glob("*.rs"))
    source = "".join(file.read_text(encoding="utf-8") for file in files)
    arguments = [*write_tables(tmp_path), "--tissue", "0.1", "0.2", "3"]
    assert main(["tables", str(tmp_path / "out"), *arguments]) == 0

    def keys(value):
        for item in value if isinstance(value, list) else []:
            yield from keys(item)
        for key, item in value.items() if isinstance(value, dict) else []:
            yield key
            yield from keys(item)

    written = set(keys(read_toml(tmp_path / "out" / "scene.toml")))
    assert {"transition_strain", "insertion_tolerance_mm", "displacements_mm"} <= written
    # `law` is the tag of the tissue's enum and no field.
    assert 'tag = "law"' in source
    assert [key for key in sorted(written - {"law"}) if f" {key}: " not in source] == []


def test_arrays_keep_every_digit_and_their_order(tmp_path):
    assert main(["tables", str(tmp_path / "out"), *write_tables(tmp_path)]) == 0
    front, root = tmp_path / "out" / "leaflet_front.vtp", tmp_path / "out" / "chords_root.vtp"
    points = vtp_numbers(front, "Points", "Points")
    marks = vtp_numbers(front, "PointData", "annulus")
    moves = vtp_numbers(front, "PointData", "annulus_displacement_mm")
    at = [points[i : i + 3] for i in range(0, len(points), 3)].index([10.1, 10.0, 0.0])
    assert marks[at] == 1 and moves[3 * at : 3 * at + 3] == [0.1, 0.2, 0.3]
    assert sum(marks) == 3 and len(marks) == 6
    assert vtp_numbers(root, "CellData", "rest_length_mm") == [10.25]
    assert vtp_numbers(root, "CellData", "area_mm2") == [0.9]
    assert vtp_numbers(root, "Points", "Points") == [0.0, 10.0, -15.0, 0.30000000000000004, 10.0, -25.0]
    letters = ElementTree.parse(front).getroot().find("PolyData/FieldData/Array")
    assert letters.get("Name") == "SPACE" and bytes(map(int, letters.text.split())) == b"LPS\0"


def test_leaflets_run_counter_clockwise_along_the_annulus(tmp_path):
    """Whatever way the table winds a leaflet, its annulus turns counter-clockwise seen from the atrium."""
    assert main(["tables", str(tmp_path / "out"), *write_tables(tmp_path)]) == 0
    for name in ("front", "back"):
        path = tmp_path / "out" / f"leaflet_{name}.vtp"
        points, marks = vtp_numbers(path, "Points", "Points"), vtp_numbers(path, "PointData", "annulus")
        corners = [int(number) for number in vtp_numbers(path, "Polys", "connectivity")]
        turning = 0
        for face in (corners[:4], corners[4:]):
            for a, b in zip(face, face[1:] + face[:1]):
                if marks[a] and marks[b]:
                    turn = points[3 * a] * points[3 * b + 1] - points[3 * a + 1] * points[3 * b]
                    assert turn > 0.0, f"{name}: edge {a}-{b}"
                    turning += 1
        assert turning == 2


def test_same_tables_same_bytes(tmp_path):
    arguments = write_tables(tmp_path)
    for name in ("one", "two"):
        assert main(["tables", str(tmp_path / name), *arguments]) == 0
    files = sorted((tmp_path / "one").iterdir())
    assert len(files) == 5
    for file in files:
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes()


def test_a_folder_with_something_in_it_is_left_alone(tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["tables", str(out), *write_tables(tmp_path)]
    out.mkdir()
    (out / "scene.toml").write_text("mine")
    assert main(arguments) == 2
    assert "--force" in capsys.readouterr().err
    assert (out / "scene.toml").read_text() == "mine"
    assert main([*arguments, "--force"]) == 0
    assert (out / "scene.toml").read_text() != "mine"


def test_column_names_are_options(tmp_path):
    nodes = NODES.replace("id,bc,annulus", "label,role,ring").replace("x0_mm,y0_mm,z0_mm", "x,y,z")
    nodes = nodes.replace("papillary", "tip")
    arguments = write_tables(tmp_path, nodes, FACES.replace("leaflet", "part"))
    arguments += ["--id-column=label", "--annulus-column=ring", "--tip-column=role", "--tip-value=tip"]
    arguments += ["--leaflet-column=part", "--position-columns", "x", "y", "z"]
    assert main(["tables", str(tmp_path / "named"), *arguments]) == 0
    assert main(["tables", str(tmp_path / "default"), *write_tables(tmp_path / "again")]) == 0
    for file in (tmp_path / "default").iterdir():
        assert file.read_bytes() == (tmp_path / "named" / file.name).read_bytes()


@pytest.mark.parametrize(
    ("table", "old", "new", "message"),
    [
        ("nodes", "z0_mm", "zz", "nodes.csv:1: column 'z0_mm' is missing"),
        (
            "nodes",
            "4,,0,,,,10,10,-8",
            "4,,0,,,,10,ten,-8",
            "nodes.csv:6: column 'y0_mm': 'ten' is not a number",
        ),
        (
            "nodes",
            "4,,0,,,,10,10,-8",
            "4,,0,,,,10,nan,-8",
            "nodes.csv:6: column 'y0_mm': 'nan' is not finite",
        ),
        (
            "nodes",
            "4,,0,,,,10,10,-8",
            "4,,0,,,,10,1e400,-8",
            "nodes.csv:6: column 'y0_mm': '1e400' is not finite",
        ),
        ("nodes", "4,,0,,,,10,10,-8", "4,,0,,,,10,10,5,-8", "nodes.csv:6: 10 cells, the header has 9"),
        ("nodes", "\n5,", "\n4,", "nodes.csv:7: column 'id': node 4 is listed twice"),
        ("nodes", ",1,", ",0,", "no node of any leaflet is on the annulus"),
        ("faces", "3,2,6,7", "3,2,66,7", "faces.csv:4: column 'c': node '66' is not in the node table"),
        ("faces", "3,2,6,7", "3,2,2,3", "faces.csv:4: column 'd': a face needs 3 different nodes, found 2"),
        ("faces", "front", "", "faces.csv:2: column 'leaflet': empty"),
        ("chords", "10.25", "0", "chords.csv:4: column 'rest_mm': 0.0 must be above 0"),
        ("chords", "5,8,", "8,8,", "chords.csv:3: column 'b': both ends are node 8"),
    ],
)
def test_wrong_input_is_one_line_that_names_the_place(tmp_path, capsys, table, old, new, message):
    texts = {"nodes": NODES, "faces": FACES, "chords": CHORDS}
    assert old in texts[table], "the case must change the table"
    texts[table] = texts[table].replace(old, new)
    assert main(["tables", str(tmp_path / "out"), *write_tables(tmp_path, **texts)]) == 2
    error = capsys.readouterr().err
    assert message in error and error.startswith("error: ") and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_missing_empty_and_foreign_files(tmp_path, capsys):
    arguments = ["tables", str(tmp_path / "out"), *write_tables(tmp_path)]
    (tmp_path / "faces.csv").write_text("")
    assert main(arguments) == 2
    assert "faces.csv:1: empty file" in capsys.readouterr().err
    (tmp_path / "faces.csv").write_bytes(FACES.encode("utf-16"))
    assert main(arguments) == 2
    assert "faces.csv: not UTF-8" in capsys.readouterr().err
    (tmp_path / "faces.csv").unlink()
    assert main(arguments) == 2
    assert "faces.csv: No such file" in capsys.readouterr().err


def test_byte_order_mark_and_windows_lines_are_read(tmp_path):
    arguments = write_tables(tmp_path)
    (tmp_path / "nodes.csv").write_bytes(b"\xef\xbb\xbf" + NODES.replace("\n", "\r\n").encode())
    assert main(["tables", str(tmp_path / "out"), *arguments]) == 0


def test_tips_are_grouped_by_the_nearest_neighbour():
    """Tips in a row 3 mm apart are one muscle at 5 mm, also when the middle one comes last."""
    places = [(0.0, 0, 0), (6.0, 0, 0), (30.0, 0, 0), (30.0, 0, 0), (3.0, 0, 0)]
    points = {str(number): Point(place, tip=True) for number, place in enumerate(places)}
    groups = muscles(Case("tips", points, {}, {}, ("pressure_kpa", 1.0)))
    assert [[tip.position_mm[0] for tip in group] for group in groups] == [[0.0, 6.0, 3.0], [30.0]]


def test_orientation_follows_the_valve_not_the_axes():
    """A valve upside down is oriented to its own atrium."""
    for sign in (1.0, -1.0):
        ring = [(5.0, 0.0, 0.0), (-3.0, 4.0, 0.0), (-3.0, -4.0, 0.0)]
        points = {str(i): Point(place, annulus=True) for i, place in enumerate(ring)}
        points["3"] = Point((0.0, 0.0, -6.0 * sign))
        leaflets = {"all": Leaflet([("0", "1", "3"), ("1", "2", "3"), ("2", "0", "3")])}
        case = Case("cone", points, leaflets, {}, ("pressure_kpa", 1.0))
        orient_to_atrium(case)
        assert leaflets["all"].faces[0] == (("0", "1", "3") if sign > 0 else ("3", "1", "0"))


# ---------------------------------------------------------------- laws

ANTERIOR = spring_fit.ExponentialLaw(0.001, 0.000124, 4.568202)


@pytest.mark.parametrize("state", ["equibiaxial", "uniaxial"])
def test_nominal_stress_is_the_derivative_of_the_energy(state):
    def energy(stretch):
        if state == "equibiaxial":
            excess = 2 * stretch**2 + stretch**-4 - 3
        else:
            excess = stretch**2 + 2 / stretch - 3
        return 0.5 * ANTERIOR.c0_mpa * excess + 0.5 * ANTERIOR.c1_mpa * (
            math.exp(ANTERIOR.c2 * excess**2) - 1
        )

    axes = 2 if state == "equibiaxial" else 1
    for stretch in (1.05, 1.2, 1.35):
        step = 1e-5
        slope = (energy(stretch + step) - energy(stretch - step)) / (2 * step) / axes
        # Central differences are good to step^2 times the third derivative, well below 1e-6 here.
        assert ANTERIOR.nominal_stress_mpa(stretch, state) == pytest.approx(slope, rel=1e-6)


def test_stretch_is_found_from_stress():
    """Neo-Hookean limit, equibiaxial: Cauchy stress c0 (s^2 - s^-4)."""
    law = spring_fit.ExponentialLaw(0.4, 0.0, 1.0)
    for stretch in (1.01, 1.3, 2.0):
        cauchy = 0.4 * (stretch**2 - stretch**-4)
        assert spring_fit.stretch_at_cauchy_stress(law, cauchy, "equibiaxial") == pytest.approx(
            stretch, rel=1e-13
        )


def test_lattice_factor_is_that_of_an_equilateral_lattice():
    """Virtual work: 3 springs per vertex of area sqrt(3)/2 L^2, each of force t w sigma, w = sqrt(3)/2 L."""
    length, sigma = 0.7, 2.0
    width = math.sqrt(3) / 2 * length
    work_per_strain = 3 * width * sigma * length / (math.sqrt(3) / 2 * length**2)
    assert work_per_strain / 2 / sigma == pytest.approx(spring_fit.LATTICE_FACTOR["equibiaxial"], rel=1e-14)


@pytest.mark.parametrize("state", ["equibiaxial", "uniaxial"])
@pytest.mark.parametrize(("c1", "c2"), [(0.000124, 4.568202), (0.000188, 14.85959), (0.000191, 17.75149)])
def test_fit_is_the_best_nearby_and_close(state, c1, c2):
    law = spring_fit.ExponentialLaw(0.001, c1, c2)
    fit = spring_fit.fit_springs(law, 0.152, state)

    def rms(springs):
        errors = []
        for stress, strain in spring_fit.spring_targets(law, 0.152, state):
            errors.append(springs.strain(stress) - strain)
        return math.sqrt(sum(error**2 for error in errors) / len(errors))

    assert rms(fit.springs) == pytest.approx(fit.strain_error_rms, rel=1e-12)
    # The working strains are 0.2-0.65; two straight lines follow the curve to a thirtieth of that.
    assert fit.strain_error_rms < 0.02
    values = vars(fit.springs)
    for key, value in values.items():
        for factor in (0.98, 1.02):
            moved = spring_fit.BilinearSprings(**{**values, key: value * factor})
            assert rms(moved) > fit.strain_error_rms, f"{key} x {factor}"


def test_ogden_modulus_is_the_slope_at_no_strain():
    terms = [(4.241553984852658, 55.914887194545429), (2.724796146859668, 55.915477229563507)]
    step = 1e-7
    rise = spring_fit.ogden_nominal_stress_mpa(terms, 1 + step) - spring_fit.ogden_nominal_stress_mpa(
        terms, 1 - step
    )
    # Differences of 1e-7 lose about 9 of 16 digits.
    assert spring_fit.ogden_modulus_mpa(terms) == pytest.approx(rise / (2 * step), rel=1e-6)


# ---------------------------------------------------------------- the two known layouts


LAW = """a 4643.4
b 49.9643
full_recruitment 0.145
eta 325000000
y0 -40625000
p_closed_dyn_cm2 -133322.368
"""


def kaiser_tables(folder: Path) -> None:
    """A cone in the generator's layout: ring 0-3, margin 4-5, chord node 6, tip 7."""
    rows = ["id,kind,leaflet,j,k,fixed,xc_mm,yc_mm,zc_mm,xo_mm,yo_mm,zo_mm"]
    ring = [(10, 0), (0, 10), (-10, 0), (0, -10)]
    for number, (x, y) in enumerate(ring):
        name = "anterior" if number < 2 else "posterior"
        rows.append(f"{number},leaflet,{name},1,2,1,{x},{y},0,{x},{y},0")
    rows += ["4,leaflet,anterior,1,1,0,3,3,-8,3,3,-9", "5,leaflet,posterior,1,1,0,-3,-3,-8,-3,-3,-9"]
    rows += ["6,chord,tree1,0,0,0,1,1,-15,1,1,-16", "7,papillary,tree1,0,0,1,0,0,-25,0,0,-25"]
    folder.mkdir()
    (folder / "nodes.csv").write_text("\n".join(rows) + "\n")
    (folder / "quads.csv").write_text("a,b,c,d\n0,1,4,4\n1,2,5,4\n2,3,5,5\n3,0,4,5\n")
    springs = "i,j,kind,rest_mm,k_dyn\n0,1,circ,9,0.005\n4,6,chord_leaf,6.5,0.0037\n6,7,chord,8.5,0.0062\n"
    (folder / "springs.csv").write_text(springs)
    (folder / "law.txt").write_text("T = words\n" + LAW)


def test_kaiser_layout(tmp_path):
    kaiser_tables(tmp_path / "cone")
    assert main(["kaiser", str(tmp_path / "cone"), str(tmp_path / "out")]) == 0
    scene = read_toml(tmp_path / "out" / "scene.toml")
    assert scene["load"] == {"pressure_kpa": 13.3322368}
    assert {leaflet["name"] for leaflet in scene["leaflets"]} == {"anterior", "posterior"}
    assert scene["leaflets"][0]["tissue"]["post_transition_modulus_mpa"] == 8.0
    assert [chord["name"] for chord in scene["chordae"]] == ["anterior"]
    assert scene["papillary"][0]["tips_mm"] == [[0.0, 0.0, -25.0]]
    # The tip is fixed too, but only leaflet nodes are annulus.
    reference = tmp_path / "out" / "closed_reference.vtp"
    assert sum(vtp_numbers(reference, "PointData", "annulus")) == 4
    assert -8.0 in vtp_numbers(reference, "Points", "Points")
    # A repeated corner makes a triangle. Quads 1-2-5-4 and 3-0-4-5 are half anterior; the first begins so.
    offsets = {
        name: vtp_numbers(tmp_path / "out" / f"leaflet_{name}.vtp", "Polys", "offsets")
        for name in ("anterior", "posterior")
    }
    assert offsets == {"anterior": [3, 7], "posterior": [3, 7]}


def collagen_tension_n(law: dict, strain: float, area_mm2: float) -> float:
    """What coapt's chord of the `collagen` law carries."""
    curved = law["scale_mpa"] * math.expm1(law["exponent"] * min(strain, law["full_recruitment_strain"]))
    beyond = max(strain - law["full_recruitment_strain"], 0.0)
    return area_mm2 * (curved + law["modulus_mpa"] * beyond)


def test_kaiser_chords_carry_the_generators_tension(tmp_path):
    kaiser_tables(tmp_path / "cone")
    assert main(["kaiser", str(tmp_path / "cone"), str(tmp_path / "out")]) == 0
    law = read_toml(tmp_path / "out" / "scene.toml")["chordae"][0]["law"]
    assert law.pop("kind") == "collagen"
    chords = tmp_path / "out" / "chords_anterior.vtp"
    rests, areas = (vtp_numbers(chords, "CellData", name) for name in ("rest_length_mm", "area_mm2"))
    assert rests == [6.5, 8.5]
    for k, area in zip([0.0037, 0.0062], areas):
        for strain in (0.02, 0.1, 0.144):
            dyn = k * 4643.4 * (math.exp(49.9643 * strain) - 1)
            assert collagen_tension_n(law, strain, area) == pytest.approx(dyn * 1e-5, rel=1e-12)
        # The generator's line begins 1.2e-6 above its curve.
        for strain in (0.145, 0.16, 0.2):
            dyn = k * (325000000 * strain - 40625000)
            assert collagen_tension_n(law, strain, area) == pytest.approx(dyn * 1e-5, rel=1.3e-6)


def test_a_kaiser_law_with_a_jump_is_refused(tmp_path, capsys):
    kaiser_tables(tmp_path / "cone")
    (tmp_path / "cone" / "law.txt").write_text(LAW.replace("y0 -40625000", "y0 -30625000"))
    assert main(["kaiser", str(tmp_path / "cone"), str(tmp_path / "out")]) == 2
    assert "the branches give 6.49999e+06 and 1.65e+07 at full recruitment" in capsys.readouterr().err


@needs_shared
def test_texas_tables():
    case = texas_case(SHARED / "data" / "texas_trivalve_healthy")
    counts = {name: len(leaflet.faces) for name, leaflet in case.leaflets.items()}
    assert counts == {"anterior": 5041, "septal": 1809, "posterior": 1433}
    assert sum(len(group.segments) for group in case.chords.values()) == 4166
    assert sum(point.annulus for point in case.points.values()) == 244
    assert sum(point.tip for point in case.points.values()) == 32
    assert case.pressure == ("pressure_kpa", 3.06)
    assert {leaflet.thickness_mm for leaflet in case.leaflets.values()} == {0.65}
    assert case.contact == {"thickness_mm": 0.24, "stiffness_mpa": 0.5}
    assert {group.insertion_radius_mm for group in case.chords.values()} == {0.0}
    # The material cards' numbers.
    assert case.leaflets["septal"].tissue.law == "exponential"
    values = {"c0_mpa": 0.001, "c1_mpa": 0.000191, "c2": 17.75149, "wrinkling": "tension-field"}
    assert case.leaflets["septal"].tissue.values == {**values, "bending_modulus_mpa": 0.01}
    # The prescribed motion is the difference of the two frames, which are rounded to 1e-5 mm.
    for point in case.points.values():
        if point.annulus:
            moved = [a + d for a, d in zip(point.position_mm, point.displacement_mm)]
            assert moved == pytest.approx(list(point.closed_mm), abs=2e-5)


@needs_shared
def test_texas_chords_follow_their_ogden_law():
    """Against W of the card itself, by differences: the table is within 1 % of the law between its points."""
    mu = (18.884147787615671, 22.682992286286954, 19.502933935159177)
    alpha = (98.253655062498183, 98.251894443391549, 98.253228660027887)

    def energy(stretch):
        parts = zip(mu, alpha)
        return sum(2 * m / a**2 * (stretch**a + 2 * stretch ** (-a / 2) - 3) for m, a in parts)

    law = texas_case(SHARED / "data" / "texas_trivalve_healthy").chords["anterior"].law
    assert law["kind"] == "table" and law["strain"][-1] == 0.02
    for group in texas_case(SHARED / "data" / "texas_trivalve_healthy").chords.values():
        assert group.law["strain"] == sorted(group.law["strain"]) and group.law["strain"][0] == 0.0
        assert group.law["stress_mpa"] == sorted(group.law["stress_mpa"]) and group.law["stress_mpa"][0] == 0.0
    for index in range(1, len(law["strain"]) - 1):
        step = 1e-6
        low, high = law["strain"][index : index + 2]
        for strain, tolerance in ((low, 1e-6), (0.5 * (low + high), 0.01)):
            slope = (energy(1 + strain + step) - energy(1 + strain - step)) / (2 * step)
            share = (strain - low) / (high - low)
            stress = (1 - share) * law["stress_mpa"][index] + share * law["stress_mpa"][index + 1]
            assert stress == pytest.approx(slope, rel=tolerance)


@needs_shared
def test_texas_leaflets_as_springs_or_compressible(tmp_path):
    tables = str(SHARED / "data" / "texas_trivalve_healthy")
    assert main(["texas", tables, str(tmp_path / "springs"), "--springs", "uniaxial"]) == 0
    assert main(["texas", tables, str(tmp_path / "soft"), "--compressible"]) == 0
    springs, soft = (read_toml(tmp_path / name / "scene.toml") for name in ("springs", "soft"))
    assert {leaflet["tissue"]["law"] for leaflet in springs["leaflets"]} == {"bilinear-springs"}
    tissues = [leaflet["tissue"] for leaflet in soft["leaflets"]]
    assert {tissue["compressibility_per_mpa"] for tissue in tissues} == {20.06689}
    assert soft["contact"] == {"thickness_mm": 0.24, "stiffness_mpa": 0.5}
    assert {group["law"]["kind"] for group in soft["chordae"]} == {"table"}
    assert {group["insertion_radius_mm"] for group in soft["chordae"]} == {0.0}
    with pytest.raises(SystemExit):
        main(["texas", tables, str(tmp_path / "both"), "--springs", "uniaxial", "--compressible"])


@needs_shared
@pytest.mark.parametrize(("name", "kpa"), [("ct_32", 13.3322368), ("normal1_64", 15.9986842)])
def test_kaiser_tables(tmp_path, name, kpa):
    assert main(["kaiser", str(SHARED / "data" / "kaiser_mitral" / name), str(tmp_path / "out")]) == 0
    scene = read_toml(tmp_path / "out" / "scene.toml")
    assert scene["load"]["pressure_kpa"] == pytest.approx(kpa, rel=1e-9)
    assert {leaflet["name"] for leaflet in scene["leaflets"]} == {"anterior", "posterior"}
    # Eight papillary points of two muscles; tips at one place are one.
    assert len(scene["papillary"]) == 2


def test_a_missing_material_card_is_named(tmp_path):
    write_tables(tmp_path)
    nodes = NODES.replace("x0_mm,y0_mm,z0_mm", "x0_mm,y0_mm,z0_mm,x20_mm,y20_mm,z20_mm")
    lines = nodes.splitlines()
    nodes = "\n".join([lines[0]] + [line + ",0,0,0" for line in lines[1:]]) + "\n"
    for suffix, text in (("nodes", nodes), ("quads", FACES), ("chords", CHORDS)):
        (tmp_path / f"healthy_{suffix}.csv").write_text(text)
    (tmp_path / "healthy_materials_and_step_excerpt.txt").write_text(
        "*Material, name=other\n*Density\n1e-9\n"
    )
    with pytest.raises(InputFault, match="no \\*shell section card with material VUANISO_ISO_front_Leaflet"):
        texas_case(tmp_path)
