"""Compares the C right-hand side of the peers with the numpy reference: all integrate the same equations."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np

from laconic.scene import Scene
from laconic.tools.report.peers import SOURCES, compile_peer, course_of


def rates_of_peer(scene: Scene, folder: Path, states: int = 20, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Rates at random states by the C source and by the reference."""
    course, random = course_of(scene), np.random.default_rng(seed)
    library = compile_peer(folder, "rhs", course, [SOURCES / "rhs.c"], ["m"])
    found, expected = [], []
    names = [f"voltage_V[{i + 1}]" for i in range(course.voltages_V.shape[1])]
    for state in random.normal(size=(states, len(course.start))):
        rates, held = np.empty_like(state), course.voltages_V[0].copy()
        library.peer_derivative(*(ctypes.c_void_p(a.ctypes.data) for a in (state, held, rates)))
        found.append(rates)
        terms = course.reference.forcing_terms(dict(zip(names, held, strict=True)))
        expected.append(course.reference.rates(state, terms))
    return np.array(found), np.array(expected)
