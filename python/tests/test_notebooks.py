"""The tool that runs the notebooks sees what is wrong with one; those of the package are run by `.ci/run`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

TOOL = Path(__file__).resolve().parents[1] / "tools" / "notebooks.py"
FOLDER = TOOL.parents[1] / "notebooks"

sys.path.insert(0, str(TOOL.parent))

from notebooks import LARGEST_BYTES, differ  # noqa: E402


def written(path: Path, source: str, output: str | None = None) -> Path:
    """A notebook of one cell, with the answer that it had."""
    cell = nbformat.v4.new_code_cell(source)
    if output is not None:
        cell.outputs = [nbformat.v4.new_output("stream", name="stdout", text=output)]
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), path)
    return path


def runs(*arguments: object) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, TOOL, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False
    )
    return done.returncode, done.stderr


def test_outputs_are_written_without_time_or_place(tmp_path):
    path = written(tmp_path / "a.ipynb", "print('sum', 1 + 1)")
    assert runs(path)[0] == 0
    notebook = nbformat.read(path, as_version=4)
    assert notebook.cells[0].outputs[0].text == "sum 2\n" and notebook.cells[0].execution_count == 1
    assert notebook.cells[0].metadata == {} and set(notebook.metadata) == {"kernelspec", "language_info"}
    first = path.read_bytes()
    assert runs(path)[0] == 0 and path.read_bytes() == first


@pytest.mark.parametrize(
    ("source", "output", "said"),
    [
        ("1 / 0", None, "ZeroDivisionError"),
        ("print('sealed')", "leaks\n", "stored: leaks"),
        ("print('area', 30)", "area 20\n", "stored: area 20"),
        ("import time; time.sleep(60)", None, "more than 12 s"),
        ("import os; print(os.getcwd())", None, "place of this machine"),
    ],
)
def test_what_is_wrong_with_a_notebook_is_said_and_nothing_written(tmp_path, source, output, said):
    path = written(tmp_path / "a.ipynb", source, output)
    before = path.read_bytes()
    # A kernel alone may take some seconds to start on a busy machine.
    code, told = runs("--check", "--limit", 12, path)
    assert code == 1 and said in told and path.read_bytes() == before


def test_numbers_may_differ_by_what_machines_make_of_them():
    assert differ("area 20.6 mm²", "area 20.7 mm²") is None
    assert differ("area 20.6 mm²", "area 24.1 mm²") is not None
    assert differ("area 20.6 mm²", "area 20.6 mm²\nwarning") is not None
    assert differ("14 closures; 637 ms", "14 closures; 1095 ms") is None
    assert differ("14 closures; 637 ms", "16 closures; 637 ms") is not None


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_is_small_whole_and_ends_with_a_picture(path):
    assert path.stat().st_size <= LARGEST_BYTES
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1)), "not run from top to bottom"
    assert any("image/png" in output.get("data", {}) for output in code[-1].outputs)
    assert "not a medical device" in notebook.cells[0].source + notebook.cells[1].source
