"""The site is whole: every public name has its place, no link is dead, and no browser goes elsewhere for it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

coapt = pytest.importorskip("coapt")
pytest.importorskip("sphinx")
pytest.importorskip("myst_nb")
pytest.importorskip("furo")

DOCS = Path(__file__).resolve().parents[2] / "docs"

#: What a browser loads by itself, by element and attribute; what only leads elsewhere when asked is free to.
LOADED = {("img", "src"), ("script", "src"), ("link", "href"), ("iframe", "src"), ("source", "src"), ("object", "data")}


class Page(HTMLParser):
    """Links, what is loaded, and places of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.places: set[str] = set()
        self.text = path.read_text(encoding="utf-8")
        self.feed(self.text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for key, value in attrs:
            if key == "id" and value:
                self.places.add(value)
            if key in ("href", "src", "data") and value:
                self.links.append(value)
                if (tag, key) in LOADED:
                    self.loaded.append(value)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built with warnings as errors: in COAPT_SITE, to be kept, else in a temporary folder."""
    folder = Path(os.environ.get("COAPT_SITE") or tmp_path_factory.mktemp("site"))
    doctrees = tmp_path_factory.mktemp("doctrees")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E", "-d", doctrees, DOCS, folder]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site) -> dict[Path, Page]:
    """All pages but those of `cargo doc`, which checks its own links."""
    paths = (path for path in site.rglob("*.html") if path.relative_to(site).parts[0] != "rust")
    return {path.resolve(): Page(path) for path in paths}


def test_every_public_name_is_on_the_page_of_the_interface(site, pages):
    places = pages[(site / "api.html").resolve()].places
    missing = [name for name in coapt.__all__ if f"coapt.{name}" not in places]
    assert not missing, f"docs/api.md lacks {missing}"
    assert {"coapt.Valve.close", "coapt.Valve.from_slicer", "coapt.Closed.orifice", "coapt.Ring.physio_like"} <= places
    assert {"coapt.Closed.report", "coapt.Closure.report", "coapt.PlanResult.report"} <= places


def test_docstrings_stand_as_they_are_written(site, pages):
    text = re.sub(r"<[^>]*>", "", pages[(site / "api.html").resolve()].text)
    assert "Whether the result may be used: converged, stable, nothing crosses." in text


def test_no_link_is_dead(pages):
    dead = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            place = unquote(parts.fragment)
            if not target.exists() or (place and target in pages and place not in pages[target].places):
                dead.append(f"{path.name}: {link}")
    assert not dead, "\n".join(dead)


def test_a_browser_loads_nothing_from_elsewhere(site, pages):
    elsewhere = [f"{path.name}: {link}" for path, page in pages.items() for link in page.loaded if urlsplit(link).netloc]
    for style in site.rglob("*.css"):
        if style.relative_to(site).parts[0] != "rust":
            told = style.read_text(encoding="utf-8")
            elsewhere += [f"{style.name}: {url}" for url in re.findall(r"(?:@import\s+|url\()\s*['\"]?((?:https?:)?//[^'\")]+)", told)]
    assert not elsewhere, "\n".join(elsewhere)


def test_every_page_says_what_it_is_not_for(pages):
    for path, page in pages.items():
        assert page.text.count('<p class="notice">') == 1, path.name
        assert "research use, not a medical device.</p>" in page.text.lower(), path.name


def test_notebooks_are_pages_with_their_pictures(site, pages):
    for notebook in sorted((DOCS / "notebooks").glob("*.ipynb")):
        page = pages[(site / "notebooks" / f"{notebook.stem}.html").resolve()]
        assert any(link.endswith(".png") for link in page.loaded), notebook.name


def test_formulas_are_drawn_by_the_browser(site, pages):
    assert pages[(site / "equations.html").resolve()].text.count("<math") > 30
