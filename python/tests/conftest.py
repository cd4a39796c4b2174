"""What tests of the package share. Tests of `python/tools` need no package, and run without it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `coapt`: that of COAPT_PROGRAM, else the one built in this workspace, else the one on the path."""
    built = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug" / "coapt"
    named = os.environ.get("COAPT_PROGRAM") or (built if built.exists() else shutil.which("coapt"))
    if named is None:
        pytest.skip("the program is not built: cargo build")
    return Path(named)
