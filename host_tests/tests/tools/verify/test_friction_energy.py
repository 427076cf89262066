"""Vehicles on ground with friction that nothing drives; assurance/long/friction.py does the same for longer."""

from __future__ import annotations

import pytest

from laconic.errors import Refused
from references.friction import coasting
from references.friction.coasting import ROUNDING, Coasted, coast, rest


@pytest.mark.parametrize("real", ["double", "single"])
def test_coasting_vehicles_never_gain_energy_and_no_step_is_refused(real):
    count = Coasted()
    for number in range(60):
        coast([5, number], count, real, 200)
    assert count.wrong == []
    assert count.refused == 0
    assert count.steps == 60 * 200
    assert count.stopped > 0
    assert count.growth <= ROUNDING[real]


@pytest.mark.parametrize("real", ["double", "single"])
def test_what_is_pulled_by_less_than_breakaway_keeps_every_bit(real):
    count = Coasted()
    for number in range(150):
        rest([5, number], count, real, 100)
    assert count.wrong == []
    assert count.resting == 150 * 100


def test_the_same_seed_finds_the_same(monkeypatch):
    found = []
    for _ in range(2):
        count = Coasted()
        coast([1, 2], count, steps=50)
        found.append(count)
    assert found[0] == found[1]


def test_energy_that_grows_is_found(monkeypatch):
    monkeypatch.setattr(coasting.Slope, "potential_J", lambda slope, plant: 1e6 * plant.steps)
    count = Coasted()
    coast([1, 2], count)
    assert count.steps == 0 and "energy grows" in count.wrong[0] and "[1, 2]" in count.wrong[0]


def test_rest_that_moves_is_found(monkeypatch):
    monkeypatch.setattr(coasting, "SHARE", 30.0)
    count = Coasted()
    for number in range(10):
        rest([1, number], count)
    assert any("has moved" in line for line in count.wrong)


@pytest.mark.parametrize(("status", "refused", "wrong"), [("step unsolved", 1, 0), ("overflow", 0, 1)])
def test_a_step_that_is_not_solved_is_counted_and_any_other_refusal_is_wrong(status, refused, wrong, monkeypatch):
    def refuse(plant, held, steps=1):
        raise Refused(status, "", 0, "as told")

    monkeypatch.setattr(coasting.Plant, "run", refuse)
    count = Coasted()
    coast([1, 2], count)
    assert (count.refused, len(count.wrong)) == (refused, wrong)
