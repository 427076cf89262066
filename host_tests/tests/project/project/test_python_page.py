"""The table of docs/python.md names parameters as the code has them, so that what it shows can be given by name."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import pytest

import laconic
from laconic.base.paths import SOURCE_DIR

ROWS = [line.split(" | ", 1) for line in (SOURCE_DIR / "docs" / "python.md").read_text(encoding="utf-8").splitlines()
        if line.startswith("| `")]
CALL = re.compile(r"`(?:\w+\.)?(\w+)\((\w[^`]*)\)`")
MAKERS = {"plant.sensors": laconic.Sensors, "plant.step_derivatives": laconic.StepDerivatives}


def calls() -> Iterator[tuple[str, list[str], list[str]]]:
    """Each call of a row, the names that it gives, and those that the code has."""
    for head, text in ROWS:
        named = re.findall(r"`([\w.]+)", head)
        if not named or not (hasattr(laconic, named[0]) or named[0] in MAKERS):
            continue
        owner = MAKERS.get(named[0]) or getattr(laconic, named[0])
        if owner is laconic.simulate:
            owner = laconic.Trajectory
        for part, holder in ((head, laconic.Plant if named[0] in MAKERS else laconic), (text, owner)):
            for name, given in CALL.findall(part):
                if found := getattr(holder, name, None):
                    words = [each.partition("=")[0].strip() for each in given.split(",")]
                    parameters = [*inspect.signature(found).parameters]
                    yield f"{name}({given})", [word for word in words if word.isidentifier()], parameters


@pytest.mark.parametrize("call, given, known", [*calls()], ids=lambda part: part if isinstance(part, str) else "-")
def test_a_call_on_the_page_names_parameters_of_the_code(call: str, given: list[str], known: list[str]) -> None:
    assert [name for name in given if name not in known] == [], call


def test_the_page_shows_calls_of_vehicles_plants_and_their_derivatives() -> None:
    shown = " ".join(call for call, given, _ in calls() if given)
    assert all(f"{name}(" in shown for name in ("derivative", "linearise", "run", "tangent", "adjoint", "make_fmu",
                                                "wheel_torques", "change", "predict", "Batch", "columns_of"))
