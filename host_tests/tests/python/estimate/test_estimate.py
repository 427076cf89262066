"""The error estimate beside proved enclosures, and how Python and the command show it."""

from __future__ import annotations

import csv
import json
import math
import random
import subprocess
import sys
from dataclasses import astuple

import pytest
from flint import arb

from assurance.long.enclosures import random_scene
from laconic.base.paths import built
from laconic.core import load
from laconic.core.estimate import NAMES
from laconic.errors import BadInput, Refused
from laconic.scene import METHODS, read_scene
from laconic.scene.methods import EXACT, EXPLICIT, EXPLICIT_8, STIFF_8
from laconic.simulation import simulate
from laconic.tools.enclosure.balls import precision
from laconic.tools.enclosure.readings import reading_of_file
from laconic.tools.enclosure.study import enclose, state_signals
from laconic.tools.report.counting import cachegrind_present, instructions_of

FACTOR = 10.0


def scenes(tmp_path, count):
    source = random.Random(16)
    for number in range(count):
        path = tmp_path / f"random_{number}.toml"
        path.write_text(random_scene(source).replace("duration_s = 1.0", "duration_s = 0.3")
                        .replace("[0.0, 0.5]", "[0.0, 0.1]"), encoding="utf-8")
        yield read_scene(path)


def true_end(scene):
    """The true states at the end, as intervals."""
    reading = reading_of_file(scene)
    return enclose(reading, reading.instants([scene.steps()]), None, "", shown=False).end.row()


def true_errors(run, states, truth):
    """Of the run's end: ν, place, heading, wheel angles; upper bounds."""
    with precision(200):
        off = [float((arb(float(run.columns[name][-1])) - true).abs_upper())
               for name, true in zip(states, truth, strict=True)]
    return max(off[:3]), math.hypot(off[3], off[4]), off[5], max(off[6:])


@pytest.mark.nightly
def test_the_estimate_is_within_a_factor_of_ten_of_the_proved_error(tmp_path):
    """Stiff up to a million times; every method that takes the steps."""
    compared, outside = 0, []
    for scene in scenes(tmp_path, 5):
        states = state_signals(scene.wheel_count)
        truth = true_end(scene.with_run(step_s=0.01))
        for method in METHODS:
            try:
                run = simulate(scene.with_run(method=method, step_s=0.01), states, estimated=True)
            except Refused:
                continue
            errors = run.errors
            for name, off, now, rounding in zip(NAMES, true_errors(run, states, truth), astuple(errors.now),
                                                astuple(errors.rounding), strict=True):
                assert now >= rounding
                if off <= 10 * rounding:
                    continue
                compared += 1
                if not off / FACTOR <= now <= FACTOR * off:
                    outside.append((scene.path.name, method, name, off, now, rounding))
                assert now > 0.01 * off, outside[-1]
    assert compared > 60
    assert len(outside) <= 0.05 * compared, outside


def test_the_bits_of_a_run_are_those_without_an_estimate():
    scene = read_scene("robotino2").with_run(duration_s=2.0)
    plain, watched = simulate(scene), simulate(scene, estimated=True)
    assert plain.errors is None and plain.error_columns == {}
    assert watched.errors is not None
    for name, column in plain.columns.items():
        assert column.tobytes() == watched.columns[name].tobytes(), name


@pytest.mark.parametrize("name", ["robotino2", "skid_steer", "canopen_agv"])
def test_columns_over_time_end_with_the_errors_of_the_end(name):
    run = simulate(read_scene(name).with_run(duration_s=1.0), estimated=True)
    assert run.errors is not None
    for signal in NAMES:
        column = run.error_columns[f"estimated_error_{signal}"]
        assert len(column) == len(run.time_s)
        assert column[-1] == getattr(run.errors.now, signal)
        assert column.max() <= getattr(run.errors.largest, signal)


def test_a_plant_has_an_estimate_that_can_be_saved():
    scene = read_scene("robotino2")
    plant = scene.plant(load("single"))
    estimate = plant.estimate(4)
    estimate.run({"voltage_V": [2.0, -2.0, 1.0]}, steps=100)
    saved, state, steps = estimate.save(), plant.save(), plant.steps
    estimate.run({"voltage_V": [2.0, -2.0, 1.0]}, steps=10)
    after = estimate.read()
    estimate.restore(saved)
    plant.restore(state, steps)
    estimate.run({"voltage_V": [2.0, -2.0, 1.0]}, steps=10)
    assert estimate.read() == after
    assert after.unknown == 0
    assert 0.0 < after.rounding.place_m <= after.now.place_m <= after.largest.place_m < 1e-3


def test_an_estimate_goes_on_with_another_vehicle_and_step():
    """Beside the same changes at a tenth of the steps, by eighth order; a refused one leaves plant and estimate."""
    scene, held = read_scene("robotino2").with_run(method=EXACT, step_s=0.02), {"voltage_V": [5.0, -3.0, 1.0]}
    plant = scene.plant(load("double"))
    fine = scene.with_run(method=STIFF_8, step_s=0.002).plant(load("double"))
    vehicle = scene.c_vehicle(load("double"))
    estimate = plant.estimate()
    estimate.run(held, steps=50)
    fine.run(held, steps=500)
    vehicle.payload.mass_kg, vehicle.payload.x_m, vehicle.payload.yaw_inertia_kgm2 = 10.0, 0.1, 0.1
    estimate.change(vehicle)
    fine.change(vehicle)
    before = estimate.read()
    with pytest.raises(Refused):
        estimate.set_step(-1.0)
    assert estimate.read() == before
    estimate.set_step(0.004)
    assert plant.step_s == 0.004
    estimate.run(held, steps=25)
    fine.run(held, steps=50)
    off = max(abs(plant.nu - fine.nu)), math.hypot(plant.pose.x_m - fine.pose.x_m, plant.pose.y_m - fine.pose.y_m)
    for error, found in zip(off, astuple(estimate.read().now), strict=False):
        assert error / FACTOR < found < FACTOR * error


@pytest.mark.parametrize(("steps", "words"), [(0, "is not positive"), (1025, "1025 is above 1024"), (2.5, "most_steps"),
                                              (10**12, "is above 1024")])
def test_windows_that_make_no_sense_are_refused_in_one_line(steps, words):
    plant = read_scene("robotino2").plant(load("double"))
    with pytest.raises((Refused, BadInput), match=words):
        plant.estimate(steps)


def command(*arguments):
    program = [sys.executable, "-m", "laconic", *arguments]
    return subprocess.run(program, capture_output=True, text=True, check=True).stdout


def test_the_command_tells_the_error_and_writes_it(tmp_path):
    out = tmp_path / "run.csv"
    told = command("simulate", "s1", "--out", str(out), "--errors")
    assert "estimated error: nu " in told and " rad/s, place " in told
    with out.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = json.loads(command("simulate", "s1", "--json"))["estimated_error"]
    assert set(found) == {"now", "largest", "rounding", "unknown"}
    for name in NAMES:
        assert float(rows[-1][f"estimated_error_{name}"]) == found["now"][name] <= found["largest"][name]


@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("method", [
    "auto", *(pytest.param(each, marks=pytest.mark.nightly) for each in (EXPLICIT, EXPLICIT_8))])
def test_a_watched_step_costs_at_most_three_fifths_more(capsys, method):
    program = str(built("bin/count_estimate"))

    def cost(window):
        few, many = (instructions_of([program, method, str(window), str(steps)]) for steps in (320, 960))
        return (many - few) / 640

    plain, watched = cost(0), cost(16)
    with capsys.disabled():
        print(f"\n{method}: a step of {plain:.0f} instructions, watched {watched / plain:.2f} times as many")
    assert watched < 1.6 * plain
