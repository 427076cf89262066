"""The plan of a sweep: what --vary says, and that a run is a function of plan and index alone."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.errors import BadInput
from laconic.scene.methods import EXPLICIT
from laconic.scene.scene_tables import scene_tables
from laconic.tools.sweep.plan import SAMPLINGS, make_plan, plan_from
from laconic.tools.sweep.varied import read_varied

MASS, RADIUS = "vehicle.mass_kg", "vehicle.wheel[*].radius_m"


def plan(*vary: str, **more):
    return make_plan(scene_tables("robotino2"), vary, (), **more)


def test_a_product_runs_through_the_last_key_fastest():
    found = plan(f"{MASS}=6:8:3", f"run.method=auto,{EXPLICIT}").values(0, 6)
    assert found[MASS].tolist() == [6.0, 6.0, 7.0, 7.0, 8.0, 8.0]
    assert found["run.method"].tolist() == ["auto", EXPLICIT] * 3


def test_each_point_of_a_grid_takes_the_same_samples():
    found = plan(f"{RADIUS}~normal(0.04,0.001)", f"{MASS}=6,8", samples=5).values(0, 10)
    assert found[MASS].tolist() == [6.0] * 5 + [8.0] * 5
    assert found[RADIUS][:5].tolist() == found[RADIUS][5:].tolist()
    assert len(set(found[RADIUS].tolist())) == 5


@pytest.mark.parametrize("sampling", sorted(SAMPLINGS))
def test_a_run_is_a_function_of_plan_and_index(sampling):
    given = plan(f"{MASS}~uniform(6,8)", f"{RADIUS}~triangular(0.03,0.04,0.05)", samples=16, seed=3, sampling=sampling)
    again, whole = plan_from(given.as_json()), given.values(0, given.runs)
    assert again.digest == given.digest
    for index in (0, 7, given.runs - 1):
        assert again.of_run(index) == {key: column[index] for key, column in whole.items()}
    assert plan(f"{MASS}~uniform(6,8)", samples=16, seed=4).digest != plan(f"{MASS}~uniform(6,8)", samples=16).digest


@pytest.mark.parametrize(("text", "mean", "deviation"), [
    ("normal(2,0.5)", 2.0, 0.5), ("uniform(1,3)", 2.0, 2.0 / np.sqrt(12.0)),
    ("triangular(0,1,5)", 2.0, np.sqrt((0 + 1 + 25 - 0 - 5 - 0) / 18.0)),
    ("lognormal(2,0.3)", 2.0 * np.exp(0.045), 2.0 * np.exp(0.045) * np.sqrt(np.exp(0.09) - 1.0))])
def test_a_distribution_has_its_mean_and_deviation(text, mean, deviation):
    values = read_varied(f"{MASS}~{text}").drawn((np.arange(20000) + 0.5) / 20000)
    assert values.mean() == pytest.approx(mean, rel=1e-3)
    assert values.std() == pytest.approx(deviation, rel=2e-3)


def test_the_ends_of_a_range_are_its_numbers():
    assert read_varied(f"{MASS}=6:8:5").levels == (6.0, 6.5, 7.0, 7.5, 8.0)
    ends = read_varied(f"{MASS}~normal(1,1)").drawn(np.array([0.0, 1.0]))
    assert ends.tolist() == pytest.approx([-7.2, 9.2], abs=0.1)


@pytest.mark.parametrize(("text", "words"), [
    ("vehicle.mass_kg", "does not say which values"), ("vehicle.mass_kg=", "does not say"),
    ("vehicle.mas_kg=1,2", "did you mean mass_kg?"), ("vehicle.mass_kg=1:2", "is no range"),
    ("vehicle.mass_kg=1:2:0", "a whole number from 1 to"), ("vehicle.mass_kg=1:2:1", "two values or more"),
    ("vehicle.mass_kg=1:1:3", "two values or more"), ("vehicle.mass_kg=1,x", "'x' is no number"),
    ("vehicle.mass_kg=1,nan", "not finite"), ("vehicle.mass_kg=1,1", "twice"), ("run.method=1:2:3", "is no range"),
    ("vehicle.wheel[1].locked=1", "neither true nor false"), ("name=a,b", "changes no run"),
    ("outputs.every_s=1,2", "changes no run"), ("vehicle.mass_kg~normal", "is no distribution"),
    ("vehicle.mass_kg~norml(1,2)", "did you mean normal?"), ("vehicle.mass_kg~normal(1)", "normal(mean, standard"),
    ("vehicle.mass_kg~normal(1,0)", "not positive"), ("vehicle.mass_kg~lognormal(-1,1)", "median"),
    ("vehicle.mass_kg~uniform(2,1)", "do not ascend"), ("vehicle.mass_kg~triangular(0,3,2)", "do not ascend"),
    ("run.method~uniform(1,2)", "not a number")])
def test_what_is_no_variation_is_refused_with_the_remedy(text, words):
    with pytest.raises(BadInput) as refused:
        read_varied(text)
    assert words in str(refused.value)


@pytest.mark.parametrize(("vary", "more", "words"), [
    ((), {}, "--vary: is missing"),
    ((f"{MASS}~normal(1,1)",), {}, "--samples: is missing"), ((f"{MASS}=1,2",), {"samples": 5}, "leave it out"),
    ((f"{MASS}=1,2", f"{RADIUS}~normal(1,1)"), {"samples": 4, "sampling": "saltelli"}, "--sensitivity"),
    ((f"{MASS}=1:2:100000", f"{RADIUS}=1:2:100000"), {}, "runs; give")])
def test_options_that_make_no_plan_are_refused(vary, more, words):
    with pytest.raises(BadInput) as refused:
        plan(*vary, **more)
    assert words in str(refused.value)
