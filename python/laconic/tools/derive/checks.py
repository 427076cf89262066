"""Checks of a derivation by numbers: the three forms against each other, and the C core against the derived rates."""

from __future__ import annotations

import numpy as np
import sympy as sp

from laconic.tools.derive.equations import System, laconic_2_3, laconic_2_4, maggi


def random_values(symbols: list[sp.Symbol], rng: np.random.Generator, count: int) -> np.ndarray:
    """Rows of random numbers for symbols; positive ones get positive numbers away from zero."""
    sizes = rng.uniform(0.5, 2.0, (count, len(symbols)))
    signs = rng.choice([-1.0, 1.0], (count, len(symbols)))
    return np.where([bool(s.is_positive) for s in symbols], sizes, sizes * signs)


def forms_difference(system: System, *, count: int = 20, seed: int = 1) -> float:
    """Largest difference between (2.3), (2.4) and (1.2) at random numbers, over the size of the equations' terms."""
    forms = [laconic_2_3(system), laconic_2_4(system), maggi(system)]
    symbols = sorted(set().union(*(e.free_symbols for form in forms for e in form)), key=str)
    evaluate = sp.lambdify(symbols, forms, "math")
    worst = 0.0
    for row in random_values(symbols, np.random.default_rng(seed), count):
        values = np.array(evaluate(*row), dtype=float)
        worst = max(worst, float(np.abs(values - values[0]).max() / max(1.0, np.abs(values).max())))
    return worst
