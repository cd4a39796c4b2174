"""The package and the program are two doors to one room: the same cases give the same bytes."""

from __future__ import annotations

import json
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
