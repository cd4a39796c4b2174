"""Pages: those of the package are those of the program, and what stands against one is said, with no half of it written."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

coapt = pytest.importorskip("coapt")

PLAN = 'schema_version = 1\nname = "rings"\n[[repair]]\nkind = "ring"\nfamily = "physio-like"\nsize_mm = [28, 32]\n'


@pytest.fixture(scope="module")
def valve():
    return coapt.generate("dilated", faces=160)


@pytest.fixture(scope="module")
def done(valve):
    return coapt.closure(valve, coapt.Ring.physio_like(30))


def page_of_program(program: Path, folder: Path, page: Path, *options: object) -> bytes:
    command = [program, "report", folder, "-o", page, *options]
    made = subprocess.run(command, check=False, capture_output=True, text=True)
    # 3: something is not certified.
    assert made.returncode in (0, 3), made.stderr
    return page.read_bytes()


def without_times(page: bytes) -> bytes:
    """The whole result stands on the page of a closure, and in it how long closing took: no two closures take the same time."""
    told, count = re.subn(rb"(&quot;|\")wall_ms(&quot;|\"): [0-9.e+-]+", b"", page)
    assert count > 0
    return told


def test_a_page_is_what_the_program_makes_of_the_same_result(program, done, tmp_path):
    """Of the same closure, times and all: every byte, with repairs, without, and with a film."""
    for name, closure in (("both", done), ("alone", done.before)):
        closure.write(tmp_path / name)
        closure.report(tmp_path / f"{name}.html")
        wanted = page_of_program(program, tmp_path / name, tmp_path / "program.html")
        assert (tmp_path / f"{name}.html").read_bytes() == wanted, name
    film = tmp_path / "closing.mcap"
    done.record(film, frames=3)
    done.report(tmp_path / "film.html", recording=film)
    wanted = page_of_program(program, tmp_path / "both", tmp_path / "program.html", "--recording", film)
    assert (tmp_path / "film.html").read_bytes() == wanted
    assert b"pressures_mmhg" in wanted and b"pressures_mmhg" not in without_film(tmp_path / "both.html")


def without_film(path: Path) -> bytes:
    """The data of a page, without its script, which knows of films on every page."""
    (data,) = re.findall(rb'<script [^>]*application/json[^>]*>(.*?)</script>', path.read_bytes(), re.DOTALL)
    return data


def test_program_and_package_make_the_same_page_of_the_same_scene(program, valve, tmp_path):
    """Closed twice, by each on its own: every byte but those of the wall-clock times."""
    scene, plan = tmp_path / "scene", tmp_path / "plan.toml"
    valve.write(scene)
    plan.write_text('schema_version = 1\n[[repair]]\nkind = "ring"\nfamily = "physio-like"\nsize_mm = 30\n')
    command = [program, "closure", scene, "--plan", plan, "--out", tmp_path / "out"]
    subprocess.run(command, check=False, capture_output=True)
    wanted = page_of_program(program, tmp_path / "out", tmp_path / "program.html")
    coapt.closure(coapt.load(scene), coapt.Ring.physio_like(30)).report(tmp_path / "package.html")
    found = (tmp_path / "package.html").read_bytes()
    assert without_times(found) == without_times(wanted)


def test_program_and_package_make_the_same_page_of_a_plan(program, valve, tmp_path):
    """A plan tells no times: every byte, with all shapes and with the first."""
    scene, plan = tmp_path / "scene", tmp_path / "plan.toml"
    valve.write(scene)
    plan.write_text(PLAN)
    command = [program, "plan", scene, plan, "--out", tmp_path / "out", "--shapes"]
    subprocess.run(command, check=False, capture_output=True)
    result = coapt.plan(coapt.load(scene), plan, keep_shapes=True)
    for options, keywords in (([], {}), (["--most", "1"], {"most": 1})):
        wanted = page_of_program(program, tmp_path / "out", tmp_path / "program.html", *options)
        result.report(tmp_path / "package.html", **keywords)
        assert (tmp_path / "package.html").read_bytes() == wanted


def test_what_stands_against_a_page_is_said_and_nothing_half_is_written(valve, done, tmp_path):
    old = tmp_path / "old.html"
    old.write_text("an old page")
    folder = tmp_path / "folder"
    folder.mkdir()
    plan = coapt.plan(valve, [coapt.Ring.physio_like(30)], keep_shapes=True)
    for result in (done, done.before, plan):
        with pytest.raises(OSError, match="folder is not a regular file"):
            result.report(folder)
        with pytest.raises(OSError, match="nowhere"):
            result.report(tmp_path / "nowhere" / "page.html")
        with pytest.raises(OSError):
            result.report("/proc/page.html")
    for recording in (tmp_path / "nowhere.mcap", old):
        with pytest.raises(coapt.InputError, match=recording.name):
            done.report(old, recording=recording)
    done.before.record(folder / "other.mcap", frames=2)
    with pytest.raises(coapt.InputError, match="is the film of another closure"):
        done.report(old, recording=folder / "other.mcap")
    with pytest.raises(coapt.InputError, match="keep_shapes"):
        coapt.plan(valve, [coapt.Ring.physio_like(30)]).report(old)
    with pytest.raises(ValueError, match="most is -1; expected a whole number from 0"):
        plan.report(old, most=-1)
    assert old.read_text() == "an old page"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "old.html"]
    done.report(old)
    assert old.read_text(encoding="utf-8").startswith("<!doctype html>")
