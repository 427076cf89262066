"""Every reference of 25 digits lies inside its enclosure; a fault put into the equation on purpose is caught."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from flint import arb

from laconic.tools.enclosure.equation import Equation
from laconic.tools.enclosure.references import enclose_case, reading_of_case
from laconic.tools.verify.trajectories import read_reference

DATA = Path(__file__).parents[2] / "data"
CASES = {f"{name}/{case.text('name')}": case for name in ("trajectories", "methods", "free_motion")
         for case in read_reference(DATA / f"{name}.json")}
TURNING, PUSHED = CASES["trajectories/omni3-driven-turning"], CASES["trajectories/caster-pushed"]


@pytest.mark.parametrize("name", CASES)
def test_a_reference_of_25_digits_lies_inside_an_enclosure_narrower_than_its_last_digit(name):
    found = enclose_case(CASES[name], None)
    assert found.outside == ()
    assert 0.0 < found.enclosed.width < 1e-24


def negative(matrix: list) -> list:
    return [[-x for x in row] for row in matrix]


FAULTS = {
    "gyro": lambda e: replace(e, gyro=[-x for x in e.gyro]),
    "damping": lambda e: replace(e, damping=negative(e.damping)),
    "voltage": lambda e: replace(e, voltage_scale=[-x for x in e.voltage_scale]),
    "heading": lambda e: replace(e, yaw_rate_of_zeta=[-x for x in e.yaw_rate_of_zeta]),
    "place": lambda e: replace(e, velocity_of_zeta=negative(e.velocity_of_zeta)),
    "wheels": lambda e: replace(e, wheel_of_zeta=negative(e.wheel_of_zeta)),
    "one velocity": lambda e: replace(e, velocity_of_zeta=[e.velocity_of_zeta[0], *negative(e.velocity_of_zeta[1:])]),
    "the 23rd digit of the gyroscopic term": lambda e: replace(e, gyro=[x * (1 + arb("1e-22")) for x in e.gyro]),
    "the 23rd digit of a motor": lambda e: replace(e, voltage_scale=[x * (1 + arb("1e-22")) for x in e.voltage_scale])}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_put_into_the_equation_on_purpose_leaves_the_reference_outside(fault):
    whole = reading_of_case(TURNING, FAULTS[fault])
    first = replace(whole, stretches=whole.stretches[:1])  # negative damping has no end
    assert enclose_case(TURNING, None, reading=first).outside


def test_a_force_fixed_in_the_world_that_turns_the_wrong_way_is_caught(monkeypatch):
    from laconic.tools.enclosure import motion

    right = motion.forcing_of

    def wrong(equation: Equation, values: dict) -> object:
        forcing = right(equation, values)
        return replace(forcing, sine=[-x for x in forcing.sine])

    assert not enclose_case(PUSHED, None).outside
    monkeypatch.setattr(motion, "forcing_of", wrong)
    assert enclose_case(PUSHED, None).outside
