"""Numbers at the edge give a right answer or a refusal with its reason, never a number that is not finite."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.benchmark.extremes import CASES, Extreme, run_case
from laconic.core import REALS, load
from laconic.scene import read_scene

REFUSED_EVERYWHERE = ("γ = 0 rad", "mass 0", "mass infinite", "radius not a number", "step 0", "step negative",
                      "step infinite", "voltage infinite", "voltage not a number", "one wheel too many")


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_extreme(case: Extreme, real: str):
    with np.errstate(all="ignore"):
        found = run_case(read_scene("s1"), case, load(real))
    assert found["outcome"] in ("right", "number", "refused"), found
    if found["outcome"] == "refused":
        assert len(found["why"]) > 20
    if case.name in REFUSED_EVERYWHERE:
        assert found["outcome"] == "refused"
