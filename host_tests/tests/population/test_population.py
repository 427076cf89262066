"""Made-up vehicles beside their true motion; `laconic soak population` takes 2,000 of them."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.core import load
from laconic.enclosure.scene_case import verify_scene_enclosed
from laconic.errors import BadInput, ResultFails
from laconic.population import collocation
from laconic.population.made import DECADES, KINDS, TICK_S, made
from laconic.population.measure import STEPS_S, measured, rows_of, states_of
from laconic.population.summary import FEW, quantile, summary_of, wrong_estimates
from laconic.population.truth import MOST_ENCLOSED, truth_of
from laconic.population.worst_scene import scene_text
from laconic.scene import read_scene
from laconic.simulation import simulate
from laconic.soak import StoppedEarly
from laconic.soak.population import AUTO, BESIDE, soak

SEED, SAMPLE = 1, 12


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Two of each kind, from usual damping to a million times that."""
    folder = tmp_path_factory.mktemp("population")
    return folder, soak(1.0, SEED, lambda _: None, vehicles=SAMPLE, out=folder)


def test_a_sample_of_all_kinds_and_dampings_passes(sample):
    folder, result = sample
    assert result["passed"], result["wrong"]
    told = json.loads((folder / "summary.json").read_text())
    assert told["done"] == SAMPLE
    assert all(told[f"auto, {step}"]["refused"] == 0 for step in ("1 ms", "10 ms"))
    assert told["auto, 1 ms"]["error_nu"]["worst"] < 1e-12
    parts = told["auto, 10 ms"]["by truth"]
    assert sum(part["vehicles"] for part in parts.values()) == SAMPLE
    assert max(part["error_nu"]["worst"] for part in parts.values()) == told["auto, 10 ms"]["error_nu"]["worst"]
    drawn = [made(SEED, number, SAMPLE) for number in range(SAMPLE)]
    assert {each.trial.kind for each in drawn} == set(KINDS)
    assert min(each.factor for each in drawn) < 10.0
    assert max(each.factor for each in drawn) > 10.0 ** (DECADES - 1)


def test_both_kinds_of_truth_are_used_and_the_enclosures_are_narrow(sample):
    folder, _ = sample
    rows = [row for line in (folder / "population.jsonl").read_text().splitlines()[1:] for row in json.loads(line)]
    for row in rows:
        assert row["truth"] == ("enclosure" if row["factor"] <= MOST_ENCLOSED else "50 digits")
        assert row["width"] < 1e-24
    assert {row["truth"] for row in rows} == {"enclosure", "50 digits"}


def test_a_wrong_sign_in_the_50_digits_lies_outside_of_the_enclosure(monkeypatch):
    right = collocation.rate_at
    monkeypatch.setattr(collocation, "rate_at", lambda k, z, heading, is_turning: [
        -x for x in right(k, z, heading, is_turning)])
    vehicle = made(SEED, 0, SAMPLE)
    with pytest.raises(ResultFails, match="outside of its enclosure"):
        truth_of(vehicle, vehicle.plant(load("double"), "auto", 0.001).nu)


def test_shorter_panels_change_no_digit_of_the_stiffest(monkeypatch):
    vehicle = made(SEED, SAMPLE - 1, SAMPLE)
    nu = vehicle.plant(load("double"), "auto", 0.001).nu
    usual = truth_of(vehicle, nu)
    for name in ("FIRST", "GROWTH", "LONGEST_S"):
        monkeypatch.setattr(collocation, name, getattr(collocation, name) / 1.7)
    finer = truth_of(vehicle, nu)
    off = max(abs(float(x - y)) for one, other in zip(usual.states, finer.states, strict=True)
              for x, y in zip(one, other, strict=True))
    assert off < 1e-22


def test_a_run_that_was_ended_goes_on_to_the_same_bytes(sample, tmp_path):
    left = 3

    def advance(amount: float) -> None:
        nonlocal left
        left -= amount > 0
        if left == 0:
            raise KeyboardInterrupt

    with pytest.raises(StoppedEarly) as early:
        soak(1.0, SEED, advance, vehicles=SAMPLE, out=tmp_path)
    assert early.value.result["vehicles"] == f"3 of {SAMPLE}"
    with (tmp_path / "population.jsonl").open("ab") as file:
        file.write(b'[{"number": 3, "half a li')
    moved: list[float] = []
    soak(1.0, SEED, moved.append, vehicles=SAMPLE, out=tmp_path)
    assert moved == [3, *[1] * (SAMPLE - 3)]
    for path in sample[0].iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_the_folder_of_another_population_is_refused(sample):
    with pytest.raises(BadInput, match="differs in seed, vehicles; give another --out"):
        soak(1.0, SEED + 1, lambda _: None, vehicles=3, out=sample[0])
    (other := sample[0].parent / "other").mkdir()
    (other / "population.jsonl").write_text("[3]\n")
    with pytest.raises(BadInput, match="is no file of a population"):
        soak(1.0, SEED, lambda _: None, vehicles=3, out=other)


@pytest.mark.parametrize("number", range(len(KINDS)))
def test_a_vehicle_runs_again_as_a_scene(number, tmp_path):
    vehicle = made(SEED, number, 2 * len(KINDS))
    plant = vehicle.plant(load("double"), "auto", STEPS_S[1])
    path = tmp_path / "worst.toml"
    path.write_text(scene_text(vehicle, plant.nu, "auto", STEPS_S[1]))
    ends = states_of(plant, vehicle, STEPS_S[1])[-1]
    scene = read_scene(path)
    signals = ["nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad"]
    again = simulate(scene, tuple(signals), progress=False)
    np.testing.assert_allclose([again.columns[name][-1] for name in signals], ends[:6], rtol=1e-11, atol=1e-12)
    row = next(row for row in rows_of(vehicle, ("auto",)) if row["step_s"] == STEPS_S[1])
    assert verify_scene_enclosed(scene, shown=False).status == "ok"
    assert row["status"] == "ok"


def test_a_refused_run_is_counted_and_has_no_errors():
    vehicle = made(SEED, SAMPLE - 1, SAMPLE)
    truth = truth_of(vehicle, vehicle.plant(load("double"), "auto", 0.001).nu)
    row = {"number": SAMPLE - 1, **measured(vehicle, truth, "rk4", 0.01)}
    assert row["status"] == "step beyond damping limit"
    assert summary_of([row]) == {"vehicles": 1, "refused": 1, "worst vehicle": SAMPLE - 1}


def test_an_estimate_beside_an_error_is_judged_above_rounding():
    row = {"number": 0, "status": "ok", "error_nu": 1e-8, "error_pose": 1e-9, "error_wheel": 1e-16}
    estimates = {"estimate_nu": 2e-8, "estimate_pose": 1e-11, "estimate_wheel": 1e-12}
    told = summary_of([row | estimates, row | estimates | {"estimate_nu": 5e-9}, row])
    assert told["estimate over error_nu"] == {"runs": 2, "least": 0.5, "median": 1.25, "largest": 2.0,
                                              "within a factor of 10": 1.0}
    assert told["estimate over error_pose"]["within a factor of 10"] == 0.0
    assert "estimate over error_wheel" not in told


def estimated(ratios: list[float]) -> dict[str, Any]:
    """What is told of rows with these ratios of estimate to error of ν."""
    rows = [{"number": k, "status": "ok", "real": "double", "error_nu": 1e-8, "error_pose": 0.0, "error_wheel": 0.0,
             "estimate_nu": ratio * 1e-8, "estimate_pose": 0.0, "estimate_wheel": 0.0}
            for k, ratio in enumerate(ratios)]
    return summary_of(rows)


def test_estimates_far_from_their_errors_are_wrong():
    assert wrong_estimates(estimated([1.0] * 95 + [11.0] * 5)) == []
    assert wrong_estimates(estimated([0.1] * 95 + [0.0101] * 5)) == []
    (few,) = wrong_estimates(estimated([1.0] * 94 + [11.0] * 6))
    assert few.startswith("94.0% of 100 estimates of nu are within a factor of 10")
    (low,) = wrong_estimates(estimated([1.0] * 99 + [0.0099]))
    assert low == "an estimate of nu is 9.9e-03 of its error, less than 0.01"
    assert len(wrong_estimates(estimated([math.nan] * 3))) == 1
    assert wrong_estimates(estimated([20.0] * (FEW - 1))) == []
    assert wrong_estimates(estimated([20.0] * FEW)) != []


def test_a_soak_with_wrong_estimates_has_not_passed(monkeypatch, tmp_path):
    monkeypatch.setattr("laconic.population.summary.LEAST", 2.0)
    result = soak(1.0, SEED, lambda _: None, vehicles=1, method="rk4,exact-flow-4", out=tmp_path)
    assert not result["passed"]
    assert any(each.startswith("exact-flow-4, 10 ms: an estimate of") for each in result["wrong"])


def test_vehicles_in_single_precision_are_given_what_the_core_is_given(tmp_path):
    result = soak(1.0, SEED, lambda _: None, vehicles=len(KINDS), real="single", out=tmp_path)
    assert result["passed"], result["wrong"]
    rows = [row for line in (tmp_path / "population.jsonl").read_text().splitlines()[1:] for row in json.loads(line)]
    assert {row["real"] for row in rows} == {"single"}
    assert max(row["error_pose"] for row in rows if row["method"] == "auto") < 1e-5
    vehicle = made(SEED, 2, len(KINDS), "single")
    assert all(np.float32(wheel[key]) == wheel[key] for wheel in vehicle.trial.table["wheel"]
               for key in ("x_m", "y_m", "axle_rad"))
    step = vehicle.plant(load("single"), "rk4", float(TICK_S["single"] / 10)).step_s
    tick = np.float32(float(TICK_S["single"]))
    assert 10 * Fraction(float(np.float32(step))) == TICK_S["single"] == Fraction(float(tick))


def test_quantiles_are_numbers_that_were_found():
    numbers = [float(n) for n in range(1, 101)]
    assert [quantile(numbers, share) for share in (0.5, 0.95, 0.99, 1.0)] == [50.0, 95.0, 99.0, 100.0]
    assert quantile([7.0], 0.5) == 7.0


@pytest.mark.parametrize("words, told", [
    ("--vehicles 0", "--vehicles"), ("--method rk5", "did you mean rk4?"), ("--out /dev/null/x", "cannot be written"),
    ("--board process", "--board process: has no effect on soak population")])
def test_wrong_options_are_one_line(words, told, capsys):
    assert run(["soak", "population", *words.split()]) == 2
    err = capsys.readouterr().err
    assert told in err
    assert err.count("\n") == 1


def test_the_method_that_users_name_is_measured(tmp_path, capsys):
    assert "taylor-8" not in (AUTO, BESIDE)
    assert run(["soak", "population", "--vehicles", "1", "--method", "taylor-8", "-o", str(tmp_path), "--json"]) == 0
    assert "refused 0 of 1" in json.loads(capsys.readouterr().out)["taylor-8, 1 ms"]
