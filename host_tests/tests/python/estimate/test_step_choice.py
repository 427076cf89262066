"""`step_s = "auto"`: the step that is found keeps the tolerance, and is a number from there on."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.core import load
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXACT, EXPLICIT_8
from laconic.scene.scene_tables import scene_tables
from laconic.scene.step_choice import candidates, run_pilot
from laconic.simulation import advance_plant, simulate
from laconic.tools.report.accuracy import state_row
from laconic.tools.verify.reference import reference_states
from moving_carriage import MOVING_CARRIAGE

STEPPED = """
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 0.5]
value = [5.0, -5.0]
"""
WAVE = """
[[input]]
signal = "voltage_V[2]"
kind = "sine"
amplitude = 5.0
frequency_Hz = 2.0
"""
AUTO = """
[run]
duration_s = 1.0
step_s = "auto"
tolerance = {}
"""


def text_of(tolerance="1e-7", inputs=STEPPED, run=AUTO):
    return MOVING_CARRIAGE + inputs + run.format(tolerance)


def scene_in(folder, text):
    path = folder / "auto.toml"
    path.write_text(text, encoding="utf-8")
    return read_scene(path)


def true_error(scene):
    plant, inputs = scene.plant(load("double")), scene.inputs_on_grid()
    advance_plant(plant, inputs, 0, scene.steps())
    end = reference_states(scene, np.array([scene.run.duration_s]))[0]
    return float(np.max(np.abs(state_row(plant) - end)))


@pytest.mark.parametrize("inputs", [STEPPED, WAVE], ids=["steps", "sine"])
@pytest.mark.parametrize("tolerance", ["1e-4", "1e-8"])
def test_the_step_that_is_found_keeps_the_tolerance_and_the_next_larger_one_does_not(tmp_path, inputs, tolerance):
    scene = scene_in(tmp_path, text_of(tolerance, inputs))
    assert scene.run.tolerance == float(tolerance)
    assert true_error(scene) <= float(tolerance)
    larger = [step for step in candidates(1.0) if step > scene.run.step_s]
    fitting = [step for step in larger if is_fitting(scene, step)]
    assert fitting and true_error(scene.with_step(fitting[-1])) > 0.1 * float(tolerance)


def is_fitting(scene, step_s):
    try:
        run_pilot(scene, step_s)
    except BadInput:
        return False
    return True


def test_it_is_a_number_from_there_on(tmp_path):
    scene = scene_in(tmp_path, text_of())
    given = scene_in(tmp_path, text_of().replace('step_s = "auto"\ntolerance = 1e-7', f"step_s = {scene.run.step_s!r}"))
    assert given.run.tolerance is None
    for name, column in simulate(given).columns.items():
        assert column.tobytes() == simulate(scene).columns[name].tobytes()
    assert scene.with_run(step_s=0.1).run.tolerance is None
    tables = scene_tables(scene_in(tmp_path, text_of()).path)
    assert tables.value("run.step_s") == scene.run.step_s
    assert tables.with_values({"vehicle.mass_kg": 11.0}).scene().run.step_s == scene.run.step_s


def test_another_method_finds_another_step(tmp_path):
    scene = scene_in(tmp_path, text_of("1e-8"))
    assert scene.with_run(method=EXACT).run.step_s < scene.run.step_s
    assert scene.with_run(method=EXPLICIT_8).run.tolerance == 1e-8


@pytest.mark.parametrize(("step", "tolerance", "words"), [
    ('"auto"', None, "run.tolerance: is missing"), ("0.01", "1e-6", "run.tolerance: has a meaning"),
    ('"automatic"', "1e-6", "run.tolerance: has a meaning"), ('"automatic"', None, "run.step_s: is the text"),
    ('"auto"', "0", "run.tolerance: is 0"), ('"auto"', "-1e-6", "run.tolerance: is -1e-06"),
    ('"auto"', "nan", "run.tolerance: is nan"), ('"auto"', '"fine"', "run.tolerance: is the text"),
    ('"auto"', "5", "run.tolerance: is 5; give 1 "), ('"auto"', "1e-17", "run.tolerance: 1e-17 is kept by no step"),
    ('"auto"', "1e-300", "the least error found is"),
])
def test_nonsense_is_one_line(tmp_path, step, tolerance, words):
    run = f"duration_s = 1.0\nstep_s = {step}\n" + (f"tolerance = {tolerance}\n" if tolerance else "")
    with pytest.raises(BadInput) as refused:
        scene_in(tmp_path, f"{MOVING_CARRIAGE}{STEPPED}[run]\n{run}")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_run_that_no_step_of_the_grid_fits_is_told(tmp_path):
    with pytest.raises(BadInput, match=r"run.step_s: no step of 1, 2 or 5 times a power of ten fits"):
        scene_in(tmp_path, text_of().replace("t_s = [0.0, 0.5]", "t_s = [0.0, 0.3333333333333]"))
