"""Chord lengths fitted to a closed surface: found again, as the program finds them, and what is no surface is said."""

from __future__ import annotations

import json
import re
import subprocess

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")

FACES = 300
"""A fit takes some forty closures: small enough for a second or two."""

TRUTH = 1.08


@pytest.fixture(scope="module")
def valve():
    return coapt.generate("healthy", faces=FACES)


@pytest.fixture(scope="module")
def image():
    return coapt.generate("healthy", faces=FACES, chordae={"rest_length_scale": TRUTH}).close()


@pytest.fixture(scope="module")
def fit(valve, image):
    return coapt.personalise(valve, image)


def test_a_factor_is_found_again(fit, image):
    # The surface is the model's own: only how leaflets slip, and where the search ends, stay of the factor (`RESOLUTION`).
    assert fit.status == "fitted" and fit.certified
    assert {group.name for group in fit.groups} == {"marginal", "intermediate", "basal", "strut"}
    assert all(group.identified and group.scale == pytest.approx(TRUTH, abs=0.005) for group in fit.groups)
    assert fit.distance_after.rms_mm < 0.1 * fit.distance_before.rms_mm
    assert fit.visible_distance_after.points <= fit.distance_after.points == image.valve.leaflet_vertex_count
    # The fitted valve is the one that the surface is of; factors a few thousandths off move it by some hundredths of a millimetre.
    assert coapt.compare(fit.after, image).distance_mm.max() < 0.2


def test_the_fitted_valve_is_a_valve_like_others(fit, valve, tmp_path):
    assert fit.before.positions_mm.tobytes() == valve.close().positions_mm.tobytes()
    assert fit.after.positions_mm.tobytes() == fit.valve.close().positions_mm.tobytes()
    assert fit.valve.with_repair(coapt.Ring.physio_like(30)).close().certified
    fit.valve.write(tmp_path / "fitted")
    again = coapt.load(tmp_path / "fitted")
    assert again.close().positions_mm.tobytes() == fit.after.positions_mm.tobytes()


def test_a_result_is_told(fit):
    pytest.importorskip("pandas")
    # One factor for all: the text has no lines of groups.
    assert "fitted" in repr(fit) and coapt.NOTICE in fit.text() and "all chordae" in fit.text()
    table = fit.to_dataframe()
    assert list(table.columns) == ["group", "scale", "interval_95_low", "interval_95_high", "identified"]
    assert (table.interval_95_low < table.scale).all() and (table.scale < table.interval_95_high).all()
    with pytest.raises(AttributeError, match="does not change"):
        fit.status = "at-bound"
    with pytest.raises(TypeError, match="coapt.personalise"):
        coapt.FitResult()


def without_times(text: str) -> str:
    told, count = re.subn(r"; \d+ ms\n", "\n", text)
    assert count == 1
    return told


def test_program_and_package_find_the_same_numbers(program, image, tmp_path):
    scene, folder = tmp_path / "scene", tmp_path / "image"
    coapt.generate("healthy", faces=FACES).write(scene)
    image.write(folder)
    surface = folder / "closed.vtp"
    command = [program, "personalise", scene, surface, "--per-group", "--format"]
    in_json, in_words = (
        subprocess.run([*command, format], check=False, capture_output=True, text=True).stdout for format in ("json", "text")
    )
    of_program = json.loads(in_json)
    fit = coapt.personalise(coapt.load(scene), surface, per_group=True)
    of_package = fit.to_dict()
    # Word for word, but for how long it took.
    assert "FITTED" in in_words and without_times(fit.text()) == without_times(in_words)
    ours = {"wall_ms", "per_group"}
    assert {key: it for key, it in of_package.items() if key not in ours} == {key: of_program[key] for key in of_package if key not in ours}


def test_what_cannot_be_fitted_is_said(valve, image):
    count = image.valve.leaflet_vertex_count
    points, triangles = np.ascontiguousarray(image.positions_mm[:count]), image.triangles
    with pytest.raises(coapt.InputError, match="has 1 repair\\(s\\); expected the patient's valve"):
        coapt.personalise(valve.with_repair(coapt.Ring.physio_like(30)), image)
    with pytest.raises(coapt.InputError, match="has no triangles"):
        coapt.personalise(valve, (points, triangles[:0]))
    with pytest.raises(coapt.InputError, match=f"point {count}; expected one of its {count} points"):
        coapt.personalise(valve, (points, np.array([[0, 1, count]])))
    with pytest.raises(coapt.InputError, match="has 3 points, expected 20 at least"):
        coapt.personalise(valve, (points, triangles[:1]))
    with pytest.raises(coapt.InputError, match="in mm and in the frame of the"):
        coapt.personalise(valve, (points * 1000.0, triangles))
    with pytest.raises(coapt.InputError, match="nowhere.vtp"):
        coapt.personalise(valve, "nowhere.vtp")
    with pytest.raises(coapt.InputError, match="the valve has none"):
        coapt.personalise(coapt.Valve([coapt.Leaflet("patch", points, triangles, annulus_points=image.valve.annulus)]), image)


def test_a_valve_with_repairs_is_no_scene(valve, tmp_path):
    with pytest.raises(coapt.InputError, match="which no scene holds"):
        valve.with_repair(coapt.Ring.physio_like(30)).write(tmp_path)
    with pytest.raises(OSError):
        valve.write("/proc/nowhere")
