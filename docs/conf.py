"""The site of coapt, built by Sphinx:

    sphinx-build -W --keep-going docs target/site

No network, neither to build nor to read it. Notebooks are shown with the outputs that `python/tools/notebooks.py` stored; its check,
which runs them all, keeps those true, and to run them here too would only cost their time again.
"""

import inspect
import os
import shutil
import sys
from importlib.metadata import version as version_of
from pathlib import Path

from sphinx.application import Sphinx

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_extensions"))

project = "coapt"
release = version = version_of("coapt")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "repository_links", "rust_text", "examples"]
exclude_patterns = ["notebooks/.ipynb_checkpoints"]
templates_path = ["_templates"]
# Parts of a page that are included begin at the depth that they have there.
suppress_warnings = ["myst.header"]

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"
#: Files outside this folder that a page includes.
pages_of_files = {
    "VALIDATION.md": "validation.md",
    "python/README.md": "start.md",
    "CONTRIBUTING.md": "contributing.md",
    "ARCHITECTURE.md": "architecture.md",
    "CHANGELOG.md": "changes.md",
    "python/tools/README.md": "tools.md",
}

# The docstrings say type, shape and unit.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "inherited-members": True}
napoleon_google_docstring = False
napoleon_use_rtype = False

html_theme = "furo"
html_title = "coapt"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False

#: What `cargo doc` wrote, if it did: copied beside the pages, one of which leads there.
RUST_PAGES = Path(os.environ.get("CARGO_TARGET_DIR", HERE.parent / "target")) / "doc"
if (RUST_PAGES / "coapt" / "index.html").exists():
    tags.add("rust_pages")  # noqa: F821: Sphinx puts it there.


def copy_rust_pages(app: Sphinx, failed: Exception | None) -> None:
    """Beside the pages, once those are written."""
    if failed is None and app.tags.has("rust_pages"):
        shutil.copytree(RUST_PAGES, Path(app.outdir) / "rust", dirs_exist_ok=True)


def as_written(_app: Sphinx, what: str, _name: str, thing: object, _options: object, lines: list[str]) -> None:
    """Napoleon takes what stands before a colon in a property's docstring for its type; ours are sentences."""
    if what == "property":
        lines[:] = (inspect.getdoc(thing) or "").splitlines()


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-docstring", as_written, priority=600)  # after Napoleon, which has 500
    app.connect("build-finished", copy_rust_pages)
