"""Reports, pictures and films of example valves, made by the program while the site is built and laid beside its pages."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sphinx.application import Sphinx

REPOSITORY = Path(__file__).resolve().parents[2]

#: Frames of the films: the site stays small, and they are smooth enough.
FRAMES = "40"

LOOP = 'kind = "neochord"\nleaflet = "posterior"\nposition = {}\nmuscle = "{}"'

#: By name: the preset, and what is done to it, as repairs of a plan.
EXAMPLES: dict[str, tuple[str, list[str]]] = {
    "healthy": ("healthy", []),
    "ring": ("dilated", ['kind = "ring"\nfamily = "physio-like"\nsize_mm = 30']),
    "neochord": ("flail", [LOOP.format(0.42, "anterolateral"), LOOP.format(0.58, "posteromedial")]),
    "clip": ("flail", ['kind = "clip"\nsite = "A2P2"']),
}


def program() -> Path | None:
    """The program as `cargo build` leaves it, or where COAPT says; none where there is none."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
    path = Path(os.environ.get("COAPT", target / "debug" / "coapt"))
    return path if path.is_file() else None


def make(coapt: Path, folder: Path) -> None:
    """Closes, films and reports each example."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as scratch:
        for name, (preset, repairs) in EXAMPLES.items():
            result = Path(scratch, name)
            words: list[str | Path] = ["closure", preset, "--out", result, "--frames", FRAMES]
            words += ["--record", folder / f"{name}.mcap", "--picture", folder / f"{name}.png"]
            if repairs:
                plan = Path(scratch, f"{name}.toml")
                body = "".join(f"\n[[repair]]\n{repair}\n" for repair in repairs)
                plan.write_text(f"schema_version = 1\n{body}", encoding="utf-8")
                words += ["--plan", plan]
            run(coapt, words)
            run(coapt, ["report", result, "--recording", folder / f"{name}.mcap", "-o", folder / f"{name}.html"])


def run(coapt: Path, words: list[str | Path]) -> None:
    done = subprocess.run([coapt, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"coapt {' '.join(map(str, words))}: {done.stderr}")


def at_the_end(app: Sphinx, failed: Exception | None) -> None:
    coapt = program()
    if failed is None and coapt is not None:
        make(coapt, Path(app.outdir) / "examples")


def setup(app: Sphinx) -> dict[str, Any]:
    if program() is not None:
        app.tags.add("examples")
    app.connect("build-finished", at_the_end)
    return {"parallel_read_safe": True}
