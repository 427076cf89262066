"""laconic/DriveToPose-v0: Gymnasium's contracts, the scalar core's bits in every lane, and refusals by name."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from laconic.cli.main import run
from laconic.core import Vehicle
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import STIFF_4
from laconic.tools.learn import EPISODE_STEPS, ID, DriveToPose, DriveToPoseVector
from laconic.tools.learn.task import OBSERVATION
from laconic.tools.report.many import race

ROOT = Path(__file__).parents[4]
SPREADS = {"vehicle.mass_kg": 0.3, "vehicle.wheel_radius_m": 0.05,
           "vehicle.motor.viscous_friction_Nms": (0.0, 1e-5)}
MIXED = {"spreads": SPREADS, "variants": 7}


def actions_of(env, count: int) -> list[np.ndarray]:
    random = np.random.default_rng(1)
    return [random.uniform(-1, 1, env.action_space.shape).astype(np.float32) for _ in range(count)]


@pytest.mark.filterwarnings("ignore:.*Box observation space")
@pytest.mark.parametrize("settings", [{}, MIXED], ids=["one vehicle", "randomised"])
def test_the_environment_passes_gymnasiums_checker(settings):
    check_env(gymnasium.make(ID, **settings).unwrapped)


def test_made_by_its_name_it_is_one_batch_and_its_episodes_end():
    many = gymnasium.make_vec(ID, 3)
    assert isinstance(many, DriveToPoseVector)
    assert many.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert many.observation_space.shape == (3, len(OBSERVATION)) and many.action_space.shape == (3, 3)
    assert gymnasium.make(ID).spec.max_episode_steps == many.max_episode_steps == EPISODE_STEPS


@pytest.mark.parametrize("real", ["double", "single"])
def test_every_lane_has_the_bits_of_the_plant_that_drives_alone(real):
    env = DriveToPoseVector(20, real=real, **MIXED)
    env.reset(seed=4)
    fleet, actions = env.fleet, actions_of(env, 3)
    plants = [fleet.vehicles[fleet.variant[lane]].plant(STIFF_4, 0.005) for lane in range(20)]
    for lane, plant in enumerate(plants):
        plant.restore(fleet.batch.state(lane), 0)
    for each in actions:
        env.step(each)
        for plant, action in zip(plants, each, strict=True):
            plant.run({"voltage_V": (12.0 * action.astype(fleet.batch.core.dtype)).tolist()}, steps=fleet.steps)
    assert len(set(fleet.variant)) > 3
    for lane, plant in enumerate(plants):
        ffi = fleet.batch.core.ffi
        assert bytes(ffi.buffer(plant.save())) == bytes(ffi.buffer(fleet.batch.state(lane)))


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("settings", [{}, MIXED], ids=["one vehicle", "randomised"])
def test_the_vector_does_what_gymnasiums_own_does_with_single_environments(mode, settings):
    lanes, steps = 5, 4
    ours = gymnasium.make_vec(ID, lanes, autoreset_mode=mode, max_episode_steps=steps, **settings)
    theirs = gymnasium.make_vec(ID, lanes, vectorization_mode="sync", vector_kwargs={"autoreset_mode": mode},
                                max_episode_steps=steps, area_m=2.0, **settings)
    np.testing.assert_array_equal(ours.reset(seed=11)[0], theirs.reset(seed=11)[0])
    for each in actions_of(ours, 11):
        mine, other = ours.step(each), theirs.step(each)
        for found, wanted in zip(mine[:4], other[:4], strict=True):
            np.testing.assert_array_equal(found, wanted)
        assert ("final_obs" in mine[4]) == ("final_obs" in other[4])
        if "final_obs" in mine[4]:
            np.testing.assert_array_equal(np.stack(mine[4]["final_obs"]), np.stack(other[4]["final_obs"]))


def test_without_autoreset_an_ended_robot_waits_for_its_reset_and_the_others_stay():
    env = DriveToPoseVector(4, max_episode_steps=2, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    first, second = actions_of(env, 2)
    env.step(first)
    assert env.step(second)[3].all()
    with pytest.raises(BadInput, match="environment 0 ended"):
        env.step(first)
    before, mask = env.fleet.observe(), np.array([True, False, True, False])
    after, _ = env.reset(options={"reset_mask": mask})
    assert (before[~mask] == after[~mask]).all() and (before[mask] != after[mask]).any(axis=1).all()
    with pytest.raises(BadInput, match="environment 1 ended"):
        env.step(first)


@pytest.mark.parametrize("make", [lambda: gymnasium.make_vec(ID, 2), DriveToPose, lambda: DriveToPoseVector(2)])
def test_what_was_closed_neither_steps_nor_begins_anew(make):
    env = make()
    env.reset(seed=0)
    action = env.action_space.sample()
    env.close()
    for what, call in (("step", lambda: env.step(action)), ("reset", env.reset)):
        with pytest.raises(BadInput, match=f"{what}: this environment is closed; make another one"):
            call()


def test_a_controller_reaches_its_targets_and_is_paid_for_it():
    env = DriveToPoseVector(8, max_episode_steps=400, area_m=0.5, autoreset_mode=AutoresetMode.DISABLED)
    seen, _ = env.reset(seed=2)
    robot = Vehicle(read_scene("robotino2").vehicle)
    rows, t = robot.matrices().wheel_rows, robot.model
    volts = float(robot.c.motor_damping_Nms / robot.c.motor_gain_Nm_per_V)
    paid, done = np.zeros(8), np.zeros(8, bool)
    for _ in range(200):
        turn = np.arctan2(seen[:, 3], seen[:, 2])
        wanted = np.stack([seen[:, 0] / t.wheel_radius_m, seen[:, 1] / t.wheel_radius_m, turn * t.yaw_scale])
        seen, rewards, terminated, _, info = env.step(np.clip(1.5 * volts * rows @ wanted / 12.0, -1, 1).T)
        paid += np.where(done, 0.0, rewards)
        done |= terminated
        if terminated.any():
            assert info["reached"][terminated].all()
            env._ended[:] = False  # the others go on
        if done.all():
            break
    assert done.all() and (paid > 1.0).all()


def test_a_robot_that_leaves_the_area_ends_without_a_bonus():
    env = DriveToPose(area_m=0.05, reach_m=0.001)
    env.reset(seed=0)
    for _ in range(100):
        _, reward, ended, _, info = env.step(np.array([1.0, 0.0, -1.0]))
        if ended:
            break
    assert ended and info == {"reached": False} and reward < 0


def test_resets_go_on_from_the_seed_and_a_seed_begins_again():
    env = DriveToPoseVector(3, **MIXED)
    first, second = env.reset(seed=5)[0], env.reset()[0]
    assert (first != second).any(axis=1).all()
    np.testing.assert_array_equal(env.reset(seed=[5, 6, 7])[0], first)
    np.testing.assert_array_equal(env.reset()[0], second)


def test_vehicles_are_drawn_within_their_spreads_once_and_by_seed():
    masses, again, others = ([v.c.mass_kg for v in DriveToPose(**MIXED, variant_seed=seed).fleet.vehicles]
                             for seed in (0, 0, 1))
    assert masses == again != others
    assert len(set(masses)) == 7 and all(8.0 * 0.7 <= mass <= 8.0 * 1.3 for mass in masses)


@pytest.mark.parametrize("settings, message", [
    ({"speed": 1.0}, "speed: is no setting"), ({"area_m": 0.0}, "area_m: 0 leaves no task"),
    ({"action_s": 0.052}, "action_s: 0.052 s is no whole number"), ({"step_s": 0}, "action_s"),
    ({"spreads": {"vehicle.mas_kg": 0.1}}, "did you mean mass_kg"), ({"spreads": {"run.step_s": 0.1}}, "no number of"),
    ({"spreads": {"vehicle.mass_kg": 1.5}}, "no share"), ({"spreads": {"vehicle.mass_kg": (9, 7)}}, "no range"),
    ({"spreads": {"vehicle.motor.viscous_friction_Nms": 0.1}}, "least value and the largest"),
    ({"spreads": {"vehicle.mass_kg": 0.1}, "variants": 0}, "variants: 0"),
    ({"variants": 0}, "variants: 0 is not from 1 to"), ({"spreads": []}, r"spreads: \[\] is no mapping"),
    ({"spreads": {"vehicle.motor.viscous_friction_Nms": (0.0, 0.01)}}, "stepped in another way"),
    ({"scene": "no_such"}, "no such scene"), ({"largest_voltage_V": np.inf}, "largest_voltage_V: inf is not finite"),
    ({"area_m": np.nan}, "area_m: nan is not finite"), ({"step_s": np.nan}, "step_s: nan is not finite"),
    ({"step_s": 0}, "action_s: 0.05 s is no whole number of steps of 0 s"), ({"threads": 0}, "threads: 0 cannot"),
    ({"spreads": [1]}, r"spreads: \[1\] is no mapping"), ({"variant_seed": -1}, "variant_seed: -1 is below 0"),
    ({"spreads": {"vehicle.mass_kg": 0.1}, "variants": None}, "variants: None is no whole number"),
    ({"spreads": {"vehicle.mass_kg": (1.0, np.inf)}}, "is not finite"),
    ({"autoreset_mode": "never"}, "autoreset_mode: there is no 'never'; give one of "),
    ({"max_episode_steps": 1.5}, "max_episode_steps: 1.5 is no whole number")])
def test_a_setting_that_does_not_fit_is_named(settings, message):
    with pytest.raises(BadInput, match=message):
        DriveToPoseVector(4, **settings)


@pytest.mark.parametrize("actions, message", [
    (np.full((2, 3), 1.01), "beyond -1 to 1"), (np.full((2, 3), np.nan), "no numbers"), (np.zeros((3, 2)), "shape"),
    (np.array([["a"] * 3] * 2), "type"), (None, "None does not fit; give real numbers of shape"),
    ([[0.0] * 3, [0.0] * 2], "does not fit")])
def test_an_action_that_is_none_is_refused_and_moves_nothing(actions, message):
    env = DriveToPoseVector(2)
    with pytest.raises(BadInput, match="call reset"):
        env.step(np.zeros((2, 3)))
    before, _ = env.reset(seed=0)
    with pytest.raises(BadInput, match=message):
        env.step(actions)
    np.testing.assert_array_equal(env.fleet.observe(), before)


def test_a_seed_for_each_and_a_mask_for_each():
    env = DriveToPoseVector(2)
    with pytest.raises(BadInput, match="3 seeds for 2"):
        env.reset(seed=[1, 2, 3])
    for seed, text in ((-1, "seed: -1 is below 0"), (1.5, "seed: 1.5 is no seed"), ("x", "seed: 'x' is no seed"),
                       ([1, "x"], r"seed\[2\]: 'x' is no whole number")):
        with pytest.raises(BadInput, match=text):
            env.reset(seed=seed)
    for options in ({"reset_mask": np.zeros(2, bool)}, {"reset_maks": np.ones(2, bool)}):
        with pytest.raises(BadInput, match="give .*reset_mask|reset_mask is no mask"):
            env.reset(options=options)


@pytest.mark.parametrize("lanes", [None, 0, -1, 1.5, "2"])
def test_a_number_of_environments_that_is_none_is_refused(lanes):
    with pytest.raises(BadInput, match="num_envs: "):
        gymnasium.make_vec(ID, lanes)


def test_a_single_robot_refuses_what_the_vector_refuses():
    env = DriveToPose()
    with pytest.raises(BadInput, match=r"step: nothing was reset yet; call reset\(\) first"):
        env.step(np.zeros(3))
    with pytest.raises(BadInput, match="seed: -1"):
        env.reset(seed=-1)
    env.reset(seed=1)
    with pytest.raises(BadInput, match=r"actions: .* of shape \(3,\)"):
        env.step(np.zeros((1, 3)))


def test_without_gymnasium_one_line_names_the_extra(monkeypatch: pytest.MonkeyPatch):
    for name in [each for each in sys.modules if each.split(".")[:3] == ["laconic", "tools", "learn"]]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(BadInput, match=r'pip install "laconic\[learn\]"'):
        importlib.import_module("laconic.tools.learn")


def test_the_pages_benchmark_prints_rates(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(race, "stay_on_one_core", lambda: None)
    page = (ROOT / "docs/batch.md").read_text(encoding="utf-8")
    words = next(line.split()[1:] for line in page.splitlines() if line.startswith("    laconic benchmark learn"))
    assert run([*words, "--lanes", "4", "--rounds", "1", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert len(rows) == 3 and all(row["thousand_actions_per_s"] > 0 for row in rows)
