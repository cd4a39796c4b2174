"""Formulas as MathML, which browsers draw themselves: no script, no fonts, no network. Docutils knows how to make it."""

from docutils import nodes
from docutils.utils.math import latex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError


def _markup(self, node, display: bool) -> str:
    try:
        return latex2mathml.tex2mathml(node.astext(), as_block=display)
    except Exception as error:  # Docutils says MathError, but for some input also IndexError or ValueError.
        raise ExtensionError(f"{self.builder.current_docname}: {node.astext()!r} is no formula: {error}") from error


def visit_inline(self, node) -> None:
    self.body.append(_markup(self, node, display=False))
    raise nodes.SkipNode


def visit_block(self, node) -> None:
    self.body.append(f'<div class="math">{_markup(self, node, display=True)}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
