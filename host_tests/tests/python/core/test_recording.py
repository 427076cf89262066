"""Rows are taken by the core while it steps: the bits of its single functions, and no Python call a row."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from laconic.base.paths import built
from laconic.core.plant import Plant
from laconic.scene import Scene, read_scene
from laconic.scene.inputs import CHUNK
from laconic.scene.signals import OUTPUT_LENGTHS, OUTPUTS_PER_WHEEL, signal_names
from laconic.scene.table import tomllib
from laconic.simulation import input_signals, simulate
from laconic.tools.report.counting import cachegrind_present, instructions_of

SCENES = ("robotino2", "turtlebot3_burger", "paper_differential_drive")
TABLE = '[[input]]\nsignal = "body_force_N[1]"\nkind = "table"\nt_s = [0.0, 1.0]\nvalue = [0.0, 2.0]\n'


def outputs_by_hand(plant: Plant, held: Any) -> dict[str, float]:
    """Every output of the present state, each from the core's function for it."""
    pose, (velocity, yaw_rate), ground = plant.pose, plant.body_velocity(), plant.reactions(held)
    many = {"nu_rad_per_s": plant.nu, "velocity_body_m_per_s": velocity, "wheel_speed_rad_per_s": plant.wheel_speeds(),
            "wheel_angle_rad": plant.wheel_angles(), "wheel_torque_Nm": plant.wheel_torques(held),
            "acceleration_body_m_per_s2": plant.body_acceleration(held),
            "wheel_reaction_N": ground.along_N, "wheel_lateral_N": ground.lateral_N}
    values = {name: getattr(pose, name) for name in ("x_m", "y_m", "origin_x_m", "origin_y_m", "heading_rad",
                                                     "heading_wrapped_rad")}
    values |= {"yaw_rate_rad_per_s": yaw_rate, "no_slip_margin_N": ground.no_slip_margin_N,
               "energy_J": plant.energy_J()}
    return values | {f"{name}[{i}]": float(v) for name, row in many.items() for i, v in enumerate(row, start=1)}


def varied(scene: Scene, tmp_path: Path) -> Scene:
    """The scene with an input that varies within steps, longer than what is made ready at once."""
    path = tmp_path / "varied.toml"
    path.write_text(scene.path.read_text() + TABLE)
    return read_scene(path).with_run(duration_s=(CHUNK + 20) * scene.run.step_s, real=scene.run.real)


@pytest.mark.parametrize("sampled", [False, True], ids=["held", "sampled"])
@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("name", SCENES)
def test_every_column_has_the_bits_of_the_cores_own_functions(tmp_path, name, real, sampled):
    scene = read_scene(name).with_run(real=real)
    scene = varied(scene, tmp_path) if sampled else scene.with_run(duration_s=200 * scene.run.step_s)
    scene = replace(scene, outputs=replace(scene.outputs, every_s=41 * scene.run.step_s))
    signals = (*signal_names(OUTPUT_LENGTHS, OUTPUTS_PER_WHEEL, scene.wheel_count), *input_signals(scene))
    run = simulate(scene, signals)
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    for row, tick in enumerate([*range(0, scene.steps(), 41), scene.steps()]):
        if sampled:
            samples = inputs.samples(plant.steps, tick - plant.steps)
            rows = np.zeros((len(samples), 3, plant.core.input_length), plant.core.dtype)
            for column, signal in enumerate(inputs.signals):
                rows[:, :, plant.core.input_offset(signal)] = samples[:, :, column]
            plant.run_sampled(rows)
        else:
            while plant.steps < tick:
                plant.run(plant.core.input(inputs.held_at(plant.steps)))
        held = inputs.held_at(tick)
        expected = outputs_by_hand(plant, plant.core.input(held)) | {signal: 0.0 for signal in input_signals(scene)}
        expected |= {signal: float(plant.core.dtype.type(value)) for signal, value in held.items()}
        assert {signal: run.columns[signal][row] for signal in signals} == {s: expected[s] for s in signals}
    assert len(run.time_s) == row + 1


def calls_of(work: Callable[[], object]) -> int:
    """Python-level calls, of Python functions and of C functions, that some work makes."""
    count = 0

    def note(frame: FrameType, event: str, arg: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("name", ["s1", "robotino2"])
def test_a_row_more_is_no_python_call_more(name):
    few = read_scene(name)
    many = replace(few, outputs=replace(few.outputs, every_s=few.run.step_s))
    simulate(few), simulate(many)  # so that nothing is loaded or imported in what is counted
    assert many.steps() > 1000
    assert calls_of(lambda: simulate(many)) <= calls_of(lambda: simulate(few)) + 5


def test_a_sampled_step_more_is_hardly_a_python_call_more(tmp_path):
    scene = varied(read_scene("robotino2"), tmp_path)
    short, long = (scene.with_run(duration_s=chunks * CHUNK * scene.run.step_s) for chunks in (1, 3))
    simulate(short)
    assert calls_of(lambda: simulate(long)) - calls_of(lambda: simulate(short)) < 0.1 * 2 * CHUNK


def steps_scene(tmp_path: Path, instants: int) -> Path:
    """A puck whose force changes at every step."""
    path = tmp_path / f"steps_{instants}.toml"
    times = ", ".join(f"{k / 1000}" for k in range(instants))
    values = ", ".join(f"{k % 7 - 3}.0" for k in range(instants))
    path.write_text("[vehicle]\nmass_kg = 2.0\nyaw_inertia_kgm2 = 0.1\nwheel_radius_m = 0.5\n"
                    f'[[input]]\nsignal = "body_force_N[1]"\nkind = "steps"\nt_s = [{times}]\nvalue = [{values}]\n'
                    f"[run]\nduration_s = {instants / 1000}\nstep_s = 0.001\n")
    return path


def test_an_instant_more_in_steps_is_no_python_call_more_to_drive(tmp_path):
    few, many = (read_scene(steps_scene(tmp_path, instants)) for instants in (500, 2000))
    simulate(few)
    assert calls_of(lambda: simulate(many)) <= calls_of(lambda: simulate(few)) + 5


@pytest.mark.nightly
def test_reading_and_driving_steps_grow_with_their_number_alone(tmp_path, capsys):
    """Calls are counted; the ratio to the time of the bare TOML reader is printed, as it differs from run to run."""
    counts = {}
    for instants in (500, 2000, 15_000, 60_000):
        path = steps_scene(tmp_path, instants)
        if instants <= 2000:
            counts[instants] = calls_of(lambda path=path: simulate(read_scene(path)))
            continue
        began = time.thread_time()
        tomllib.loads(path.read_text())
        toml_s, began = time.thread_time() - began, time.thread_time()
        simulate(read_scene(path))
        with capsys.disabled():
            print(f"\n{instants} instants: read and driven in {(time.thread_time() - began) / toml_s:.2f} times "
                  f"the {toml_s:.2f} s of the TOML reader alone")
    assert counts[2000] < 4.0 * counts[500]


# ---- What a recorded row costs beside a step, in instructions: the same on every run.

LEAST, MOST = 300, 900  # steps: what a count of one run has in common with another's cancels
LIMIT = 20.0              # rows cost at most so many steps

needs_cachegrind = pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")


@cache
def cost(kind: str, every: int, watch: int) -> float:
    """Instructions for each step, rows and watch included."""
    program = str(built("bin/count_record"))
    least, most = (instructions_of([program, kind, str(every), str(watch), str(steps)]) for steps in (LEAST, MOST))
    return (most - least) / (MOST - LEAST)


@pytest.mark.nightly
@needs_cachegrind
@pytest.mark.parametrize(("watch", "what"), [(0, "without the ground"), (1, "with the no-slip margin")])
def test_a_row_costs_at_most_twenty_steps(capsys, watch, what):
    step = cost("held", 0, 0)
    row = cost("held", 1, watch) - step
    with capsys.disabled():
        print(f"\na row {what}: {row:.0f} instructions, {row / step:.1f} steps of {step:.0f}")
    assert row / step < LIMIT


@pytest.mark.nightly
@needs_cachegrind
def test_watching_the_ground_costs_at_most_twenty_steps_and_nothing_where_it_is_off(capsys):
    step, watched = cost("held", 0, 0), cost("held", 0, 2)
    with capsys.disabled():
        print(f"\na watched step: {watched / step:.1f} steps; unwatched: {cost('held', 0, 1) / step:.3f}")
    assert watched / step < LIMIT
    assert cost("held", 0, 1) == pytest.approx(step, rel=0.01)


@needs_cachegrind
def test_a_sampled_step_costs_at_most_twenty_held_ones(capsys):
    step, sampled = cost("held", 0, 0), cost("sampled", 0, 0)
    with capsys.disabled():
        print(f"\na sampled step: {sampled / step:.1f} held ones")
    assert sampled / step < LIMIT
