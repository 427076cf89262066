"""A figure as text inside a page, small enough for a phone's width."""

from __future__ import annotations

import io

import matplotlib as mpl
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from laconic.pictures.plotting import check_formulas

SIZE = (4.5, 3.9)  # inches; at a phone's 390 pixels its letters are still of reading size
TITLE_LETTERS = 44  # in a line of that width


def svg(picture: Figure) -> str:
    """The figure as an svg element without prolog; text stays text, identifiers stay the same in every run."""
    check_formulas(picture)
    out = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "laconic"}):
        picture.savefig(out, format="svg", metadata={"Date": None})
    plt.close(picture)
    text = out.getvalue()
    return text[text.index("<svg"):]
