"""Links of pages that are included from elsewhere in the repository: to the page of the site that has them, else to none.

A file that is no page is named where a link to it stood; pictures are taken from where they are.
"""

import os
import re
from pathlib import Path, PurePosixPath

from sphinx.application import Sphinx

LINK = re.compile(r"(?P<picture>!?)\[(?P<text>[^\]]*)\]\((?P<target>[^)\s#]+)(?P<anchor>#[^)\s]*)?\)")


def rewrite(app: Sphinx, path: Path, _page: str, content: list[str]) -> None:
    """The text of a file that is included, its links made those of the site."""
    folder = (Path(app.srcdir) / path).resolve().parent
    root = Path(app.srcdir).parent.resolve()

    def link(match: re.Match[str]) -> str:
        target = match["target"]
        if "://" in target:
            return match[0]
        file = (folder / target).resolve()
        if match["picture"]:
            return f"![{match['text']}]({_relative(file, app.srcdir)})"
        name = file.relative_to(root).as_posix()
        page = app.config.pages_of_files.get(name)
        if page is None and PurePosixPath(name).parent == PurePosixPath("docs"):
            page = file.name
        return f"[{match['text']}](/{page}{match['anchor'] or ''})" if page else f"`{name}`"

    content[0] = LINK.sub(link, content[0])


def _relative(file: Path, folder: str | os.PathLike[str]) -> str:
    return Path(os.path.relpath(file, folder)).as_posix()


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_config_value("pages_of_files", {}, "env")
    app.connect("include-read", rewrite)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
