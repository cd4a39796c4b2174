"""Every wrong scene of `assets/bad` is told through the package as through the program, whose words its own tests check."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

coapt = pytest.importorskip("coapt")

BAD = Path(__file__).resolve().parents[2] / "assets" / "bad"
CASES = sorted(path.name for path in BAD.iterdir() if path.suffix in (".toml", ".json"))
FEWEST_CASES = 200
"""Fewer would mean that the folder is not read."""


def told_by_the_package(case: str) -> list[tuple[str, str, str]]:
    try:
        faults = coapt.load(case).warnings
    except coapt.InputError as refused:
        faults = refused.faults
    return sorted((fault.severity, fault.place, fault.message) for fault in faults)


def told_by_the_program(program: Path, case: str) -> list[tuple[str, str, str]]:
    checked = subprocess.run([program, "check", "--format", "json", case], capture_output=True, text=True, timeout=60)
    faults = json.loads(checked.stdout)["faults"]
    return sorted((fault["severity"], fault["place"], fault["message"]) for fault in faults)


def test_the_folder_is_read():
    assert len(CASES) > FEWEST_CASES


@pytest.mark.parametrize("case", CASES)
def test_a_wrong_scene_is_told_as_by_the_program(case, program, monkeypatch):
    monkeypatch.chdir(BAD)
    assert told_by_the_package(case) == told_by_the_program(program, case)
