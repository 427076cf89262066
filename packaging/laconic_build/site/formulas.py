"""Formulas of the pages as MathML, which browsers draw by themselves: no script, no font and no network."""

from __future__ import annotations

from typing import TYPE_CHECKING

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.errors import ExtensionError

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

LONG = 40  # characters; a longer formula within a sentence scrolls by itself where the page is narrow


def setup(app: Sphinx) -> dict[str, bool]:
    """What Sphinx calls: `html_math_renderer = "mathml"` then names these two."""
    app.add_html_math_renderer("mathml", (_in_line, None), (_of_its_own, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _in_line(page: HTML5Translator, node: nodes.math) -> None:
    made = _mathml(node, "inline")
    page.body.append(f'<span class="long-formula">{made}</span>' if len(node.astext()) > LONG else made)
    raise nodes.SkipNode


def _of_its_own(page: HTML5Translator, node: nodes.math_block) -> None:
    page.body.append(f'<div class="formula">{_mathml(node, "block")}</div>\n')
    raise nodes.SkipNode


def _mathml(node: nodes.Element, display: str) -> str:
    """Refuses what the converter does not know: it would write such a command into the page as it stands."""
    made = str(convert(node.astext(), display=display))
    if "\\" in made:
        raise ExtensionError(f"{node.source}:{node.line}: {node.astext()!r} has a command that becomes no MathML")
    return made
