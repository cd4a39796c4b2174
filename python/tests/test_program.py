"""The package and the program are two doors to one room: the same cases give the same bytes."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

from vtp_reader import read_vtp  # noqa: E402

CASES = {
    "healthy": (["healthy"], []),
    "flail-with-clip": (["flail"], [coapt.Clip(site="A2P2", size="long")]),
    "dilated-with-ring": (["dilated"], [coapt.Ring.physio_like(30, attachment="sutures", sutures=14)]),
    "ruptured-and-mended": (
        ["healthy"],
        [
            coapt.Rupture(region="P2"),
            coapt.Neochord(leaflet="posterior", site="A2P2", strands=2),
            coapt.RelocatePapillary(muscle="posteromedial", toward="mid-anterior", distance_mm=3.0),
        ],
    ),
}


def toml_of(repairs) -> str:
    lines = ["schema_version = 1"]
    for repair in repairs:
        lines.append("[[repair]]")
        lines += [f"{key} = {json.dumps(value)}" for key, value in repair.to_dict().items()]
    return "\n".join(lines) + "\n"


def without_times(report: dict) -> dict:
    for state in ("before", "after"):
        report.get(state, {}).get("solve", {}).pop("wall_ms", None)
    return report


@pytest.mark.parametrize("name", CASES)
def test_program_and_package_write_the_same_bytes(program, tmp_path, name):
    (preset,), repairs = CASES[name]
    scene = tmp_path / "scene"
    subprocess.run([program, "generate", preset, "--set", "faces=300", "--out", scene], check=True, capture_output=True)
    command = [program, "closure", scene, "--out", tmp_path / "program"]
    if repairs:
        plan = tmp_path / "plan.toml"
        plan.write_text(toml_of(repairs))
        command += ["--plan", plan]
    subprocess.run(command, check=False, capture_output=True)

    valve = coapt.load(scene)
    done = coapt.closure(valve, *repairs)
    done.write(tmp_path / "package")

    files = sorted(path.relative_to(tmp_path / "program") for path in (tmp_path / "program").rglob("*.*"))
    assert files == sorted(path.relative_to(tmp_path / "package") for path in (tmp_path / "package").rglob("*.*"))
    for file in files:
        of_program, of_package = (tmp_path / door / file for door in ("program", "package"))
        if file.name == "report.json":
            told = [without_times(json.loads(path.read_text())) for path in (of_program, of_package)]
            assert told[0] == told[1]
        else:
            assert of_program.read_bytes() == of_package.read_bytes(), file

    last = done.after or done.before
    folder = tmp_path / "program" / ("after" if repairs else "")
    positions = read_vtp(folder / "closed.vtp").points
    count = last.valve.leaflet_vertex_count
    assert positions.tobytes() == np.ascontiguousarray(last.positions_mm[:count]).tobytes()


def test_a_generated_valve_is_the_one_that_is_written(program, tmp_path):
    scene = tmp_path / "scene"
    subprocess.run(
        [program, "generate", "barlow", "--set", "faces=300", "--set", "annulus.transverse_mm=44", "--out", scene],
        check=True,
        capture_output=True,
    )
    generated = coapt.generate("barlow", faces=300, annulus={"transverse_mm": 44})
    loaded = coapt.load(scene)
    assert generated.points_mm.tobytes() == loaded.points_mm.tobytes()
    assert generated.close().positions_mm.tobytes() == loaded.close().positions_mm.tobytes()


def test_program_and_package_plan_alike(program, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text('schema_version = 1\n[[repair]]\nkind = "ring"\nfamily = "physio-like"\nsize_mm = [28, 32]\n')
    scene = tmp_path / "scene"
    subprocess.run([program, "generate", "dilated", "--set", "faces=160", "--out", scene], check=True, capture_output=True)
    subprocess.run([program, "plan", scene, plan, "--out", tmp_path / "program"], check=True, capture_output=True)
    coapt.plan(coapt.load(scene), plan).write(tmp_path / "package")
    for file in ("plan.json", "plan.csv", "plan_long.csv", "plan_units.csv"):
        assert (tmp_path / "program" / file).read_bytes() == (tmp_path / "package" / file).read_bytes(), file


def test_the_same_faults_are_told_in_the_same_words(program, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('schema_version = 1\nname = "a"\nload = { pressure_mmhg = -1 }\nleaflets = []\n')
    told = subprocess.run([program, "check", scene], check=False, capture_output=True, text=True)
    assert told.returncode == 2
    with pytest.raises(coapt.InputError) as caught:
        coapt.load(scene)
    lines = (told.stdout + told.stderr).splitlines()
    for fault in caught.value.faults:
        assert any(fault.message in line for line in lines), (fault, lines)


@pytest.fixture(scope="module")
def scene(program, tmp_path_factory) -> Path:
    """A small valve as the program writes it."""
    folder = tmp_path_factory.mktemp("valve") / "scene"
    subprocess.run([program, "generate", "dilated", "--set", "faces=160", "--out", folder], check=True, capture_output=True)
    return folder


def printed(program, *arguments) -> str:
    return subprocess.run([program, *arguments], check=False, capture_output=True, text=True).stdout


def test_program_and_package_check_alike(program, scene):
    text = (scene / "scene.toml").read_text()
    line = text[: text.index("pressure_mmhg")].count("\n") + 1
    wrong, doubtful = scene / "wrong.toml", scene / "doubtful.toml"
    wrong.write_text(re.sub("pressure_mmhg = .*", "pressure_mmhg = -100.0", text))
    doubtful.write_text(re.sub("pressure_mmhg = .*", "pressure_mmhg = 1000.0", text))
    for path, severities in ((scene, []), (wrong, ["error"]), (doubtful, ["warning"])):
        told = coapt.check(path)
        assert [fault.severity for fault in told.faults] == severities and told.ready is ("error" not in severities), told.text()
        assert told.text() == printed(program, "check", path)
        assert told.to_dict() == json.loads(printed(program, "check", path, "--format", "json"))
    assert coapt.check(wrong).errors[0].place == f"{wrong}:{line}"
    few = coapt.check(scene, max_faces=100)
    assert not few.ready and few.triangles is None
    assert few.text() == printed(program, "check", scene, "--max-faces", "100")
    valve = coapt.load(doubtful)
    of_valve = coapt.check(valve)
    assert of_valve.faults == valve.warnings == of_valve.warnings and of_valve.triangles == len(valve.triangles)
    assert of_valve.springs == coapt.check(doubtful).springs
    assert not coapt.check("nowhere.toml").ready


def test_program_and_package_export_alike(program, scene, tmp_path):
    text = (scene / "scene.toml").read_text()
    membranes = scene / "membranes.toml"
    tissue = '[leaflets.tissue]\nlaw = "st-venant-kirchhoff"\nmodulus_mpa = 0.4\nbending_modulus_mpa = 0.0\n\n'
    membranes.write_text(re.sub(r"\[leaflets\.tissue\]\n(.+\n)*\n", tissue, text))
    springs, scene = scene, membranes
    valve = coapt.load(scene)
    for engine in ("calculix", "febio"):
        of_program, of_package = (tmp_path / f"{door}.{engine}" for door in ("program", "package"))
        subprocess.run([program, "export", scene, "--format", engine, "--out", of_program], check=True, capture_output=True)
        assert coapt.export(valve, of_package, format=engine) == ()
        assert of_program.read_bytes() == of_package.read_bytes()
    results = tmp_path / "results.csv"
    places = valve.close().positions_mm
    results.write_text("node,x,y,z\n" + "".join(f"{n + 1},{x!r},{y!r},{z!r}\n" for n, (x, y, z) in enumerate(places.tolist())))
    of_program, of_package = (tmp_path / f"{door}.vtp" for door in ("program", "package"))
    told = subprocess.run(
        [program, "export", scene, "--results", results, "--out", of_program], check=True, capture_output=True, text=True
    )
    warnings = coapt.export(valve, of_package, results=results)
    assert [f"warning: {fault}" for fault in warnings] == told.stderr.splitlines()
    assert of_program.read_bytes() == of_package.read_bytes()
    with pytest.raises(ValueError, match="neither of format and results"):
        coapt.export(valve, of_package)
    with pytest.raises(ValueError, match="both of format and results"):
        coapt.export(valve, of_package, format="febio", results=results)
    with pytest.raises(ValueError, match="format is 'abaqus'; expected"):
        coapt.export(valve, of_package, format="abaqus")
    with pytest.raises(coapt.InputError, match="not sewn together"):
        coapt.export(valve.with_repair(coapt.Clip(site="A2P2")), of_package, format="febio")
    refused = subprocess.run([program, "export", springs, "--format", "febio", "--out", of_program], check=False, capture_output=True, text=True)
    with pytest.raises(coapt.InputError, match="no equal in FEBio") as caught:
        coapt.export(coapt.load(springs), of_package, format="febio")
    assert [f"error: {fault}" for fault in caught.value.faults] == refused.stderr.splitlines()
    with pytest.raises(coapt.InputError, match="nowhere"):
        coapt.export(valve, of_package, results=tmp_path / "nowhere.dat")
    with pytest.raises(OSError):
        coapt.export(valve, "/proc/nowhere/a.feb", format="febio")


def test_program_and_package_fit_tissue_alike(program, tmp_path):
    curve = tmp_path / "curve.csv"
    rows = [(1 + 0.01 * n, 1 + 0.02 * n, 0.02 * (math.exp(0.5 * n) - 1), 0.01 * (math.exp(0.5 * n) - 1)) for n in range(19)]
    curve.write_text(
        "stretch_circ,stretch_rad,tension_circ_n_per_m,tension_rad_n_per_m\n"
        + "".join(",".join(map(repr, row)) + "\n" for row in rows)
    )
    given = {
        "--anisotropic": {"anisotropic": True},
        "--up-to=60": {"up_to_kpa": 60.0},
    }
    for options in ([], ["--anisotropic"], ["--up-to=60"], list(given)):
        keywords = {key: value for option in options for key, value in given[option].items()}
        fit = coapt.fit_tissue(curve, thickness_mm=0.8, **keywords)
        command = ["fit-tissue", curve, "--thickness", "0.8", *options]
        assert fit.text() == printed(program, *command)
        assert fit.to_dict() == json.loads(printed(program, *command, "--format", "json"))
        # The block of the text is the tissue that is given.
        keys = fit.tissue.to_dict()
        assert f'law = "{keys["law"]}"' in fit.text()
        for key, value in keys.items() if "circumferential" not in keys else keys["radial"].items():
            if key not in ("law", "compression_modulus_ratio"):
                assert f"{key} = {value!r}" in fit.text()
        assert fit.rms_error_mpa < fit.rms_stress_mpa and fit.working_range_mpa == (0.0, 1e-3 * keywords.get("up_to_kpa", 100.0))
    with pytest.raises(coapt.InputError, match="thickness"):
        coapt.fit_tissue(curve)
    with pytest.raises(coapt.InputError, match="nowhere"):
        coapt.fit_tissue("nowhere.csv")


def test_program_and_package_study_laws_alike(program, scene, tmp_path):
    def timeless(folder: Path) -> dict:
        told = json.loads((folder / "laws.json").read_text())
        return {**told, "rows": [{**row, "wall_ms": None} for row in told["rows"]]}

    subprocess.run(
        [program, "study", "healthy", "--laws", "--faces", "160", "--reference-faces", "300", "--repeats", "1", "--out", tmp_path / "a"],
        check=True,
        capture_output=True,
    )
    done = coapt.study("healthy", laws=True, faces=[160], reference_faces=300, repeats=1)
    done.write(tmp_path / "b")
    assert timeless(tmp_path / "a") == timeless(tmp_path / "b")
    assert {row["certified"] for row in done.rows} == {True} and done.rows[0]["mesh_error"] is not None
    # A scene has no reference but its own mesh.
    subprocess.run([program, "study", scene, "--laws", "--repeats", "1", "--out", tmp_path / "c"], check=True, capture_output=True)
    of_scene = coapt.study(coapt.load(scene), laws=True, repeats=1)
    of_scene.write(tmp_path / "d")
    assert timeless(tmp_path / "c") == timeless(tmp_path / "d")
    assert len(of_scene.to_dataframe()) == len(of_scene.rows)
    with pytest.raises(ValueError, match="not tried beside laws"):
        coapt.study("healthy", laws=True, tolerances=(1e-3,))


def test_program_and_package_draw_alike(program, scene, tmp_path):
    closure = coapt.closure(coapt.load(scene), coapt.Ring.physio_like(30))
    plan = tmp_path / "plan.toml"
    plan.write_text(toml_of([coapt.Ring.physio_like(30)]))
    for colour in ("gap", "strain", "displacement", "leaflet"):
        for made, options in ((closure.before, []), (closure, ["--plan", plan])):
            command = [program, "closure", scene, *options, "--picture", tmp_path / "a.png", "--colour", colour]
            subprocess.run(command, check=True, capture_output=True)
            made.picture(tmp_path / "b.png", colour=colour)
            assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with pytest.raises(coapt.InputError, match="ends in .png"):
        closure.picture(tmp_path / "a.jpg")
    with pytest.raises(ValueError, match="colour is 'blue'; expected"):
        closure.picture(tmp_path / "a.png", colour="blue")
