"""laconic.Batch: each lane is the plant that steps alone; arrays are views; what does not fit is refused by name."""

from __future__ import annotations

import os
import platform
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import laconic
from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT

ROOT = Path(__file__).parents[4]
PAGE = (ROOT / "docs/batch.md").read_text(encoding="utf-8")
LANES = 37


def robot(mass_kg: float = 8.0, real: str = "double", **more) -> laconic.Vehicle:
    wheels = [{"kind": "omni", "x_m": 0.125 * np.cos(a), "y_m": 0.125 * np.sin(a), "axle_rad": a}
              for a in np.radians([60, 180, 300])]
    return laconic.Vehicle({"mass_kg": mass_kg, "yaw_inertia_kgm2": 0.0625, "wheel_radius_m": 0.04,
                            "wheel_inertia_kgm2": 0.0019, "motor_gain_Nm_per_V": 0.138, "motor_damping_Nms": 0.114,
                            "wheel": wheels, **more}, real)


def cart() -> laconic.Vehicle:
    wheels = [{"kind": "fixed", "y_m": y, "axle_rad": -np.pi / 2} for y in (0.08, -0.08)]
    return laconic.Vehicle({"mass_kg": 1.0, "yaw_inertia_kgm2": 2.4e-3, "wheel_radius_m": 0.033,
                            "wheel_inertia_kgm2": 2e-5, "motor_gain_Nm_per_V": 0.1, "motor_damping_Nms": 0.2,
                            "wheel": wheels})


def filled(batch: laconic.Batch) -> laconic.Batch:
    random = np.random.default_rng(5)
    batch.voltage_V[:] = random.uniform(-6, 6, batch.voltage_V.shape)
    batch.body_moment_Nm[:] = random.uniform(-0.1, 0.1, batch.lane_count)
    batch.world_force_N[0, ::3] = 1.0
    return batch


def state_bytes(core, state) -> bytes:
    return bytes(core.ffi.buffer(state))


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("method", ["auto", EXPLICIT])
def test_each_lane_is_the_plant_that_steps_alone(real, method):
    kinds = [robot(5.0 + k, real) for k in range(LANES)]
    batch = filled(laconic.Batch(kinds, method=method, step_s=0.01))
    for lane in range(LANES):
        batch.start(lane, x_m=0.1 * lane, heading_rad=0.3 * lane)
    assert batch.run(20) == 0
    assert batch.run(5, threads=2) == 0
    for lane in range(LANES):
        plant = kinds[lane].plant(method, 0.01, x_m=0.1 * lane, heading_rad=0.3 * lane)
        plant.run({"voltage_V": batch.voltage_V[:, lane], "body_moment_Nm": batch.body_moment_Nm[lane],
                   "world_force_N": batch.world_force_N[:, lane]}, steps=25)
        assert state_bytes(batch.core, plant.save()) == state_bytes(batch.core, batch.state(lane))
        assert (plant.pose.x_m, plant.pose.y_m) == (batch.x_m[lane], batch.y_m[lane])
        assert plant.pose.heading_rad == batch.heading_rad[lane]
        assert np.array_equal(plant.nu, batch.nu_rad_per_s[:, lane])


def test_every_width_gives_the_same_bits():
    core = load("double")
    widths = [width for width in (1, 16, 32, 64) if core.lib.laconic_batch_width(width)]
    runs = [filled(laconic.Batch(robot(), LANES, step_s=0.01, width_bytes=width)) for width in widths]
    assert [run.width_bytes for run in runs] == widths
    assert max(widths) == laconic.Batch(robot()).width_bytes
    for run in runs:
        run.run(50)
    states = [[state_bytes(core, run.state(lane)) for lane in range(LANES)] for run in runs]
    assert all(state == states[0] for state in states)


def test_arrays_are_views_of_the_memory_that_steps():
    batch = laconic.Batch([robot(), cart()], kind_of=np.arange(LANES) % 2)
    assert batch.voltage_V.shape == (3, LANES)
    assert batch.world_force_N.shape == (2, LANES)
    voltages, x = batch.voltage_V, batch.x_m
    voltages[:] = 3.0
    voltages[1] = 5.0
    batch.run(100)
    assert np.all(x[1::2] > 0)
    assert not np.shares_memory(batch.voltage_V[0], batch.voltage_V[1])
    for name in ("x_m", "y_m", "heading_rad", "nu_rad_per_s", "status", "missed"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(batch, name)[:] = 1


def test_a_lane_that_is_refused_stays_and_tells_why_and_the_others_go_on():
    batch = filled(laconic.Batch(robot(), LANES, EXPLICIT, 0.01))
    batch.voltage_V[1, 7] = np.nan
    before = state_bytes(batch.core, batch.state(7))
    assert batch.run(10) == 1
    assert state_bytes(batch.core, batch.state(7)) == before
    assert (batch.missed[7], batch.missed[8]) == (10, 0)
    assert np.flatnonzero(batch.status).tolist() == [7]
    assert batch.refusal(8) is None
    why = batch.refusal(7)
    assert isinstance(why, laconic.Refused)
    assert "voltage_V" in str(why)
    batch.voltage_V[1, 7] = 1.0
    assert batch.run(10) == 0
    assert batch.status[7] == 0
    assert batch.missed[7] == 10


@pytest.mark.parametrize("threads", [1, 2])
def test_sampled_voltages_act_as_a_run_for_each_sample(threads):
    kinds = [robot(5.0 + k % 3) for k in range(LANES)]
    sampled, one_by_one = (filled(laconic.Batch(kinds, step_s=0.01)) for _ in range(2))
    voltages = np.random.default_rng(7).uniform(-6, 6, (8, 3, LANES))
    voltages[5, 1, 9] = np.nan
    for sample in voltages[:5]:
        one_by_one.voltage_V = sample
        assert one_by_one.run(4) == 0
    before = state_bytes(one_by_one.core, one_by_one.state(9))
    for sample in voltages[5:]:
        one_by_one.voltage_V = sample
        one_by_one.run(4)
    assert sampled.run_sampled(voltages, 4, threads) == 1
    assert state_bytes(sampled.core, sampled.state(9)) == before
    assert sampled.missed[9] == 12
    assert "voltage_V" in str(sampled.refusal(9))
    for lane in (0, 8, 10, LANES - 1):
        assert state_bytes(sampled.core, sampled.state(lane)) == state_bytes(one_by_one.core, one_by_one.state(lane))
        assert sampled.heading_rad[lane] == one_by_one.heading_rad[lane]
    assert np.array_equal(sampled.voltage_V[:, 0], voltages[-1, :, 0])


WRONG = {
    "voltage_V: an array of shape (5, 2, 3) and type float64 does not fit; give real numbers of shape (samples, 3":
        lambda: laconic.Batch(robot(), 2).run_sampled(np.zeros((5, 2, 3))),
    "steps_each: 'all' is no whole number": lambda: laconic.Batch(robot(), 2).run_sampled(np.zeros((5, 3, 2)), "all"),
    "vehicles: none is given": lambda: laconic.Batch([]),
    "vehicles: None is no laconic.Vehicle and no list": lambda: laconic.Batch(None, 3),
    "vehicles[2]: 'cart' is no laconic.Vehicle": lambda: laconic.Batch([robot(), "cart"]),
    "vehicles[2]: is of single precision": lambda: laconic.Batch([robot(), robot(real="single")]),
    "vehicles[1]: has ground friction": lambda: laconic.Batch(robot(ground={"friction_coefficient": 0.5})),
    "lanes: 3 lanes for 2 vehicles": lambda: laconic.Batch([robot(), cart()], 3),
    "lanes: 0 is not from 1": lambda: laconic.Batch(robot(), 0),
    "lanes: -1 is not from 1": lambda: laconic.Batch(robot(), -1),
    "lane: there is no -1": lambda: laconic.Batch(robot(), 2).state(-1),
    "threads: -1 cannot take a step": lambda: laconic.Batch(robot(), 2).run(1, threads=-1),
    "width_bytes: this processor has no registers of -16": lambda: laconic.Batch(robot(), 2, width_bytes=-16),
    "state: None is no laconic_state": lambda: laconic.Batch(robot(), 2).load(0, None),
    "kind_of: [[1], [1, 2]] is no row": lambda: laconic.Batch([robot(), cart()], kind_of=[[1], [1, 2]]),
    "kind_of: 0 to 2 are not all kinds": lambda: laconic.Batch([robot(), cart()], kind_of=[0, 1, 2]),
    "kind_of: has the shape (2, 1)": lambda: laconic.Batch([robot(), cart()], kind_of=[[0], [1]]),
    "kind_of: 1 lanes for 2 vehicles": lambda: laconic.Batch([robot(), cart()], kind_of=[0]),
    "method: there is no 'rk5'": lambda: laconic.Batch(robot(), 2, "rk5"),
    "width_bytes: this processor has no": lambda: laconic.Batch(robot(), 2, width_bytes=24),
    "run.step_s: -1 is not positive": lambda: laconic.Batch(robot(), 2, step_s=-1.0),
    "lane: there is no 2": lambda: laconic.Batch(robot(), 2).state(2),
    "threads: 0 cannot take a step": lambda: laconic.Batch(robot(), 2).run(1, threads=0),
    "voltage_V: [1.0, 2.0, 3.0] does not fit; give real numbers of shape (3, 2)": lambda: setattr(
        laconic.Batch(robot(), 2), "voltage_V", [1.0, 2.0, 3.0]),
    "voltage_V: 'high' does not fit": lambda: setattr(laconic.Batch(robot(), 2), "voltage_V", "high"),
    "voltage_V: None does not fit": lambda: setattr(laconic.Batch(robot(), 2), "voltage_V", None),
    "voltage_V: ['1', '2'] does not fit": lambda: setattr(laconic.Batch(robot(), 2), "voltage_V", ["1", "2"]),
    "voltage_V: [(1+1j), 2] does not fit": lambda: setattr(laconic.Batch(robot(), 2), "voltage_V", [1 + 1j, 2]),
    "body_force_N: np.datetime64('2020') does not fit": lambda: setattr(
        laconic.Batch(robot(), 2), "body_force_N", np.datetime64("2020")),
    "body_moment_Nm: True does not fit": lambda: setattr(laconic.Batch(robot(), 2), "body_moment_Nm", True),
    "voltage_V: [[[None, 1], [1, 1], [1, 1]]] does not fit": lambda: laconic.Batch(robot(), 2).run_sampled(
        [[[None, 1], [1, 1], [1, 1]]]),
    "lanes: True is no whole number": lambda: laconic.Batch(robot(), True),
    "step_s: True is no number": lambda: laconic.Batch(robot(), 2, step_s=True),
    "steps: True is no whole number": lambda: laconic.Batch(robot(), 2).run(True),
    "x_m: np.timedelta64(3,'h') is no number": lambda: laconic.Batch(robot(), 2).start(0, x_m=np.timedelta64(3, "h")),
    "y_m: np.complex128(1j) is no number": lambda: laconic.Batch(robot(), 2).start(0, y_m=np.complex128(1j)),
    "status: is no input of a batch": lambda: setattr(laconic.Batch(robot(), 2), "status", 0),
    "voltages_V: is no input of a batch": lambda: setattr(laconic.Batch(robot(), 2), "voltages_V", 0),
    "steps: 1.5 is no whole number": lambda: laconic.Batch(robot(), 2).run(1.5),
    "x_m: nan is not finite": lambda: laconic.Batch(robot(), 2).start(0, x_m=np.nan),
    "heading_rad: None is no number": lambda: laconic.Batch(robot(), 2).start(0, heading_rad=None),
    "nu_rad_per_s: [1, 2] does not fit; give real numbers of shape (3,) in rad/s": lambda: laconic.Batch(
        robot(), 2).start(0, nu_rad_per_s=[1, 2]),
    "nu_rad_per_s[2]: inf is not finite": lambda: laconic.Batch(robot(), 2).start(0, nu_rad_per_s=[0, np.inf, 0]),
    "width_bytes: 'wide' is no whole": lambda: laconic.Batch(robot(), 2, width_bytes="wide"),
}


def test_an_input_given_as_a_whole_is_written_into_the_memory_that_steps():
    whole, placed = laconic.Batch(robot(), 4), laconic.Batch(robot(), 4)
    voltages = np.arange(12.0).reshape(3, 4)
    whole.voltage_V, placed.voltage_V[:] = voltages, voltages
    voltages += 1  # a copy was taken
    whole.run(200)
    placed.run(200, threads=10**9)
    assert whole.heading_rad.tobytes() == placed.heading_rad.tobytes()
    assert np.any(whole.heading_rad != 0)


@pytest.mark.parametrize(("method", "force_N", "nu", "point_m"), [
    (EXACT, (-4.7, -1.1), (-6.6, -1.7, -5.3), (-0.2, 0.3)),
    (EXACT_4, (8.9, -3.6), (3.7, -0.4, -5.2), (0.1, 0.0))])
def test_a_lane_that_leaves_the_usual_way_while_the_heading_at_a_steps_end_is_sought_has_its_bits(
        method, force_N, nu, point_m):  # noqa: N803
    """A force fixed in the world depends on that heading, which rounds find; the first may leave and the last not."""
    body = laconic.Vehicle({"mass_kg": 10.0, "yaw_inertia_kgm2": 0.24, "com_x_m": 0.08, "com_y_m": 0.06,
                            "wheel_radius_m": 0.09})
    start = body.plant(method, step_s=0.3, nu_rad_per_s=nu).save()
    states = []
    for width_bytes in (1, 0):
        batch = laconic.Batch(body, 1, method, 0.3, width_bytes=width_bytes)
        batch.load(0, start)
        batch.world_force_N[:, 0], batch.world_force_point_m[:, 0] = force_N, point_m
        batch.run(40)
        states.append(bytes(batch.core.ffi.buffer(batch.state(0))))
    assert states[0] == states[1]


@pytest.mark.parametrize("message", WRONG)
def test_what_does_not_fit_is_refused_in_one_line(message):
    with pytest.raises(laconic.BadInput) as caught:
        WRONG[message]()
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_the_examples_of_the_page_print_what_the_page_says(capsys):
    examples = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)
    names = {}
    for code, printed in examples:
        exec(compile(code, "batch.md", "exec"), names)  # noqa: S102
        assert capsys.readouterr().out == printed
    assert len(examples) == 2


# ---- A batch after os.fork(): the threads stayed with the parent, so the child begins new ones.

ignores_fork_warning = pytest.mark.filterwarnings("ignore:.*fork")


needs_batch_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")


LONGEST_S = 60


@needs_batch_fork
@ignores_fork_warning
def test_a_batch_runs_on_threads_in_a_child_and_in_its_parent() -> None:
    batch = laconic.Batch(laconic.Vehicle.of(laconic.read_scene("robotino2")), 256, step_s=0.01)
    batch.voltage_V[:] = np.linspace(-6.0, 6.0, 256)
    batch.run(10, threads=2)
    reader, writer = os.pipe()
    if (child := os.fork()) == 0:
        signal.alarm(LONGEST_S)  # a child that waits for ever fails the test
        try:
            batch.run(10, threads=2)
            batch.run(10, threads=2)
            os.write(writer, batch.x_m.tobytes())
        finally:
            os._exit(0)
    os.close(writer)
    batch.run(20, threads=2)
    with os.fdopen(reader, "rb") as pipe:
        found = np.frombuffer(pipe.read())
    assert os.waitpid(child, 0)[1] == 0
    assert found.tolist() == batch.x_m.tolist()


# ---- The look for fused multiply-adds in the lanes' objects finds one where there is one, and passes over none.

PRODUCT = """
double fused(double a, double b, double c) { return a * b + c; }
double apart(double a, double b) { return a * b; }
"""


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("cc") or not shutil.which("objdump"),
                    reason="no C compiler for x86-64 or no objdump")
@pytest.mark.parametrize(("options", "status"), [(["-mfma", "-ffp-contract=fast"], 1), (["-mavx2"], 0),
                                                 (["-mfma", "-ffp-contract=off"], 0)])
def test_a_fused_multiply_add_is_found_with_its_function(tmp_path: Path, options, status):
    source, made = tmp_path / "product.c", tmp_path / "product.o"
    source.write_text(PRODUCT, encoding="utf-8")
    subprocess.run(["cc", "-O2", "-c", *options, str(source), "-o", str(made)], check=True)
    found = looked_at("objdump", made)
    assert found.returncode == status
    assert ("product.o: fused has vfmadd" in found.stderr) is bool(status) and "apart" not in found.stderr


def test_without_objdump_the_look_is_skipped_in_one_line(tmp_path: Path):
    found = looked_at(str(tmp_path / "objdump"), tmp_path / "a.o")
    assert (found.returncode, found.stdout.count("\n"), found.stderr) == (77, 1, "")
    assert found.stdout.startswith("skipped: no objdump")


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for objdump")
def test_arms_names_of_fused_operations_are_known(tmp_path: Path):
    objdump = tmp_path / "objdump"
    lines = ("0 <f>:", " 0:\tfmadd d0, d1, d2, d0", " 4:\tfmla v0.2d, v1.2d, v2.2d", " 8:\tfmul d0, d1, d2")
    objdump.write_text("\n".join(["#!/bin/sh", "cat <<END", *lines, "END", ""]), encoding="utf-8")
    objdump.chmod(0o755)
    found = looked_at(str(objdump), tmp_path / "a.o")
    assert found.stderr.splitlines() == ["a.o: f has fmadd", "a.o: f has fmla"]


def looked_at(objdump: str, made: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, str(SOURCE_DIR / "core_c/tests/bits/not_fused.py"), objdump, str(made)],
                          capture_output=True, text=True, check=False)


# ---- A lane becomes another vehicle while the batch lives: with that vehicle's bits, and refused where it cannot.

def changed_robot(mass_kg: float = 8.0, real: str = "double", **more) -> laconic.Vehicle:
    table = dict(laconic.read_scene("robotino2").vehicle)
    return laconic.Vehicle({**table, "mass_kg": mass_kg, **more}, real)


def test_a_changed_lane_has_the_bits_of_its_new_vehicle_and_the_others_keep_theirs():
    batch = laconic.Batch([changed_robot(5.0 + lane) for lane in range(9)], step_s=0.01)
    heavy = changed_robot(40.0)
    batch.voltage_V[:] = [[4.0], [-1.0], [2.0]]
    batch.change(3, batch.prepared(heavy))
    batch.run(5)
    for lane in range(9):
        plant = (heavy if lane == 3 else changed_robot(5.0 + lane)).plant("auto", 0.01)
        plant.run({"voltage_V": [4.0, -1.0, 2.0]}, steps=5)
        assert (plant.pose.x_m, plant.pose.y_m) == (batch.x_m[lane], batch.y_m[lane])
        assert plant.wheel_speeds().tobytes() == of_lane(batch, lane, plant)


def of_lane(batch: laconic.Batch, lane: int, plant: laconic.Plant) -> bytes:
    plant.restore(batch.state(lane), 0)
    return plant.wheel_speeds().tobytes()


def test_what_a_lane_cannot_become_is_refused_and_the_lane_stays():
    batch, shared = laconic.Batch([changed_robot(), changed_robot(9.0)], step_s=0.01), laconic.Batch(changed_robot(), 2)
    with pytest.raises(laconic.BadInput, match="lane: 1 shares its kind"):
        shared.change(1, shared.prepared(changed_robot(9.0)))
    crossed = laconic.Batch([changed_robot(), changed_robot(9.0)], step_s=0.01, kind_of=[1, 1])
    with pytest.raises(laconic.BadInput, match="lane: 0 shares its kind"):
        crossed.change(0, crossed.prepared(changed_robot(7.0)))
    with pytest.raises(laconic.BadInput, match="another way"):
        batch.change(1, batch.prepared(changed_robot(9.0), EXPLICIT))
    with pytest.raises(laconic.BadInput, match="no laconic_batch_kind of this core; make it with batch.prepared"):
        batch.change(1, changed_robot())
    with pytest.raises(laconic.BadInput, match="vehicle: is of single precision"):
        batch.prepared(changed_robot(real="single"))
    with pytest.raises(laconic.BadInput, match="vehicle: has ground friction"):
        batch.prepared(changed_robot(friction_coefficient=0.0, ground={"friction_coefficient": 0.4}))
    batch.voltage_V[:] = 2.0
    batch.run(3)
    plant = changed_robot(9.0).plant("auto", 0.01)
    plant.run({"voltage_V": [2.0] * 3}, steps=3)
    assert plant.pose.heading_rad == batch.heading_rad[1]
