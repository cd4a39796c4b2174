"""Types: complete, true, and strict; no `Any` in what people call."""

from __future__ import annotations

import inspect
import subprocess
import sys
import typing
from pathlib import Path

import pytest

coapt = pytest.importorskip("coapt")
pytest.importorskip("mypy")

SOURCE = Path(coapt.__file__).parent


def passes(*command: str, where: Path | None = None) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, check=False, cwd=where)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_strictly_typed(tmp_path):
    passes("mypy", "--strict", "--python-version", "3.10", f"--cache-dir={tmp_path}", str(SOURCE))


def test_stubs_say_what_the_native_half_has(tmp_path):
    passes("mypy.stubtest", "coapt._coapt", "--ignore-disjoint-bases", where=tmp_path)


def test_a_strict_user_needs_no_help(tmp_path):
    """What a person writes is typed through and through, and a wrong keyword is found before anything runs."""
    good = tmp_path / "good.py"
    good.write_text(
        "import coapt\n"
        "valve = coapt.generate('healthy', faces=160, annulus={'transverse_mm': 40})\n"
        "closed = valve.with_repair(coapt.Ring.physio_like(28)).close(pressure_mmhg=110)\n"
        "length: float = closed.coaptation.length_mean_mm\n"
        "names: tuple[str, ...] = valve.leaflet_names\n"
        "reveal_type(closed.positions_mm.dtype)\n"
    )
    passes("mypy", "--strict", f"--cache-dir={tmp_path / 'cache'}", str(good))
    bad = tmp_path / "bad.py"
    bad.write_text("import coapt\ncoapt.Ring(family='sadle')\ncoapt.Clip(width=3)\n")
    command = [sys.executable, "-m", "mypy", "--strict", f"--cache-dir={tmp_path / 'cache'}", str(bad)]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    assert "bad.py:2" in told and "bad.py:3" in told, told


def public():
    for name in coapt.__all__:
        it = getattr(coapt, name)
        if inspect.isfunction(it):
            yield name, it
        if inspect.isclass(it):
            yield name, it
            for key, member in vars(it).items():
                member = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
                if inspect.isfunction(member) and not key.startswith("_"):
                    yield f"{name}.{key}", member


@pytest.mark.parametrize(("name", "it"), list(public()), ids=lambda it: it if isinstance(it, str) else "")
def test_every_public_name_is_documented_and_typed(name, it):
    assert inspect.getdoc(it), name
    if inspect.isfunction(it):
        told = it.__annotations__
        assert "return" in told, name
        assert "Any" not in " ".join(str(kind) for kind in told.values()), name


def test_all_names_what_there_is():
    assert sorted(coapt.__all__) == sorted(set(coapt.__all__))
    assert coapt.__version__.count(".") == 2
    assert typing.get_args(coapt.Repair) and typing.get_args(coapt.Tissue)
