"""How curves that may lie on each other, and long names, are drawn in the pictures of analyses and reports."""

from __future__ import annotations

import textwrap
from typing import Any

THICK, THIN = 3.6, 0.9  # points: the first of curves that coincide, and the last


def nested(order: int, count: int) -> dict[str, Any]:
    """Line width and place of curve `order` (from 0) of `count`: each later one is thinner and lies on top.

    So where curves coincide, the earlier ones show on both sides of the later ones.
    """
    share = order / max(1, count - 1)
    return {"linewidth": THICK + share * (THIN - THICK), "zorder": 2.0 + share}


def taking_turns(order: int, count: int) -> tuple[int, int]:
    """`markevery` of curve `order` of `count`: where curves coincide, their markers do not."""
    return order % count, count


def wrapped(title: str, letters: int) -> str:
    """A title in lines of so many letters, so that a long name is not cut."""
    return "\n".join(textwrap.wrap(" ".join(title.split()), letters)) or title
