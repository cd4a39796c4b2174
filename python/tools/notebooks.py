"""Runs the notebooks, each in a fresh kernel, and stores what their cells answer; or checks that they still run and answer so.

    python python/tools/notebooks.py              # runs all and writes their outputs
    python python/tools/notebooks.py --check      # runs all, writes nothing, fails if anything is wrong
    python python/tools/notebooks.py FILE...      # these only

Wrong is: a cell that raises; a notebook that takes more than a minute; a place of this machine in an output; with `--check` also
words that differ from those stored, or numbers by more than other machines may make them. How fast a machine is does not matter:
milliseconds and seconds may be any, and so may all that cells tagged `times` tell.

Needs nbclient and ipykernel besides what the notebooks need.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
LIMIT_S = 60.0
LARGEST_BYTES = 250_000

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
DURATION = re.compile(r"\d+(?:\.\d+)? (?=m?s\b)")
#: The last bits of a closure depend on the machine's instructions. Its measures differ by far less than this, but for a pleat
#: that falls in another way.
RELATIVE, ABSOLUTE = 0.05, 0.1
#: Where an interpreter, a home or a temporary folder may show.
MACHINE = re.compile(r"/(?:home|root|tmp|usr|var|work|Users|private)/[^\s'\"]*|ipykernel_\d+")


class Wrong(Exception):
    """What is wrong with a notebook."""


def run(notebook: nbformat.NotebookNode, limit_s: float) -> nbformat.NotebookNode:
    """The notebook with the outputs of a fresh kernel, in a folder of its own.

    The limit is that of a machine which does nothing else: where others are at work, it is as many times longer as they are.
    """
    fresh = nbformat.from_dict(notebook)
    busy = max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(
            fresh,
            timeout=math.ceil(busy * limit_s),
            kernel_name="python3",
            record_timing=False,
            extra_arguments=["--log-level=ERROR"],  # it warns that the kernel listens on a local port
            resources={"metadata": {"path": folder}},
        )
        try:
            client.execute()
        except CellTimeoutError:
            raise Wrong(f"a cell takes more than {limit_s:g} s") from None
        except CellExecutionError as error:
            raise Wrong(f"a cell fails:\n{error}") from None
    taken = time.monotonic() - begun
    if taken > busy * limit_s:
        raise Wrong(f"takes {taken:.0f} s, expected {limit_s:g} s at most, {busy:.1f} times that on this busy machine")
    return normalised(fresh)


def normalised(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Without what tells of a machine or a moment."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for number, cell in enumerate(notebook.cells):
        cell.id = f"cell-{number:02}"
        kept = {"tags": cell.metadata["tags"]} if "tags" in cell.metadata else {}
        cell.metadata = nbformat.from_dict(kept)
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
    for place in MACHINE.findall(told(notebook)):
        raise Wrong(f"a place of this machine is in an output: {place}")
    return notebook


def joined(outputs: list[nbformat.NotebookNode]) -> list[nbformat.NotebookNode]:
    """Pieces of one stream arrive as they are flushed: made one."""
    kept: list[nbformat.NotebookNode] = []
    for output in outputs:
        if output.output_type == "stream" and kept and kept[-1].get("name") == output.name:
            kept[-1].text += output.text
        else:
            kept.append(output)
    return kept


def told(notebook: nbformat.NotebookNode, *, times: bool = True) -> str:
    """What the cells answer in words; without those of cells that tell times, if so asked."""
    texts = []
    for cell in notebook.cells:
        if cell.cell_type != "code" or (not times and "times" in cell.metadata.get("tags", [])):
            continue
        for output in cell.outputs:
            texts.append(output["text"] if output.output_type == "stream" else output.get("data", {}).get("text/plain", ""))
    return "\n".join(texts)


def differ(stored: str, fresh: str) -> str | None:
    """The first line that is not as it was; numbers may differ by what other machines make of them."""
    before, after = (DURATION.sub("any ", text).splitlines() for text in (stored, fresh))
    for was, now in zip(before, after):
        words = [" ".join(NUMBER.sub("#", line).split()) for line in (was, now)]
        numbers = [[float(number) for number in NUMBER.findall(line)] for line in (was, now)]
        near = (math.isclose(a, b, rel_tol=RELATIVE, abs_tol=ABSOLUTE) for a, b in zip(*numbers))
        if words[0] != words[1] or not all(near):
            return f"  stored: {was}\n  now:    {now}"
    return None if len(before) == len(after) else f"  stored: {len(before)} lines\n  now:    {len(after)}"


def handle(path: Path, *, check: bool, limit_s: float) -> None:
    """Runs one notebook, then compares or writes it."""
    stored = nbformat.read(path, as_version=4)
    fresh = run(stored, limit_s)
    if check:
        difference = differ(told(stored, times=False), told(fresh, times=False))
        if difference:
            raise Wrong(f"answers are not those stored; if they should differ, run without --check:\n{difference}")
        return
    text = nbformat.writes(fresh) + "\n"
    if len(text) > LARGEST_BYTES:
        raise Wrong(f"has {len(text)} bytes, expected {LARGEST_BYTES} at most: smaller pictures")
    path.write_text(text, encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("files", nargs="*", type=Path, help="notebooks [default: all]")
    parser.add_argument("--check", action="store_true", help="write nothing, compare")
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="S", help="seconds for a notebook [default: 60]")
    arguments = parser.parse_args()
    os.environ.pop("MPLBACKEND", None)  # The kernel's own puts pictures into the notebook.
    failed = False
    for path in arguments.files or sorted(FOLDER.glob("*.ipynb")):
        begun = time.monotonic()
        try:
            handle(path, check=arguments.check, limit_s=arguments.limit)
            print(f"{path.name}: {time.monotonic() - begun:.0f} s", flush=True)
        except Wrong as wrong:
            failed = True
            print(f"{path.name}: {wrong}", file=sys.stderr, flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
