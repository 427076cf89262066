"""What sensors show in a run: against closed forms, an integrator of its own, and the path that they lead back to."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.scene import Scene
from laconic.scene.methods import EXPLICIT_8
from laconic.simulation import simulate
from laconic.tools.verify.reference import reference_states
from sensor_scenes import BODY, ENCODERS, ERRORS, IMU, PLACE, RUN, SINES, STEPS, WHEELS, sensed_scene

AT, TURNED_RAD = np.array([0.15, -0.1]), math.radians(30)  # as PLACE
COM = np.array([0.04, 0.03])
IDEAL = f"[sensors.imu]\n{PLACE}"
IMU_SIGNALS = ("imu_acceleration_m_per_s2", "imu_yaw_rate_rad_per_s")


def turned(vector: np.ndarray, angle_rad: float | np.ndarray) -> np.ndarray:
    """Rows of vectors, turned to the left."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], -1)


def place_of(scene: Scene, at_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the IMU is in the world, and the heading, by SciPy and none of the core."""
    states = reference_states(scene, at_s)
    return states[:, 3:5] + turned(np.broadcast_to(AT - COM, (len(at_s), 2)), states[:, 5]), states[:, 5]


def test_on_a_steady_circle_it_feels_the_centripetal_acceleration_of_its_place(tmp_path: Path) -> None:
    speed, yaw_rate, mass = 1.5, 2.0, 3.0  # a puck that a force to the left, M v ω, holds on a circle
    puck = f"[vehicle]\nmass_kg = {mass}\nyaw_inertia_kgm2 = 0.1\nwheel_radius_m = 0.5\n"
    force = ('[[input]]\nsignal = "body_force_N[2]"\nkind = "steps"\nt_s = [0.0]\n'
             f"value = [{mass * speed * yaw_rate}]\n"
             f"[initial]\nvelocity_body_m_per_s = [{speed}, 0.0]\nyaw_rate_rad_per_s = {yaw_rate}\n")
    scene = sensed_scene(tmp_path, force, IDEAL, "[run]\nduration_s = 3.0\nstep_s = 0.01\n", head=puck)
    found = simulate(scene, (*IMU_SIGNALS, "acceleration_body_m_per_s2", "x_m"))
    assert np.ptp(found.columns["x_m"]) == pytest.approx(2.0 * speed / yaw_rate, rel=1e-3)
    expected = turned(np.array([-yaw_rate**2 * AT[0], speed * yaw_rate - yaw_rate**2 * AT[1]]), -TURNED_RAD)
    after = found.columns_of("imu_acceleration_m_per_s2")[1:]  # the first sample is that without the force
    np.testing.assert_allclose(after, np.broadcast_to(expected, after.shape), rtol=1e-12)
    np.testing.assert_allclose(found.columns["imu_yaw_rate_rad_per_s"], yaw_rate, rtol=1e-12)
    of_origin = found.columns_of("acceleration_body_m_per_s2")
    np.testing.assert_allclose(of_origin, [[0.0, speed * yaw_rate]] * 301, atol=1e-12)


def test_an_ideal_imu_shows_the_second_derivative_of_its_places_path_by_another_integrator(tmp_path: Path) -> None:
    scene = sensed_scene(tmp_path, SINES, IDEAL,
                         f"[run]\nduration_s = 1.0\nstep_s = 0.001\nmethod = \"{EXPLICIT_8}\"\n")
    found, h = simulate(scene, IMU_SIGNALS), 2e-3
    for tick in (50, 333, 700, 950):
        path, heading = place_of(scene, tick * 0.001 + h * np.arange(-2, 3))
        second = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) @ path / (12.0 * h * h)  # fourth order
        expected = turned(second, -heading[2] - TURNED_RAD)
        np.testing.assert_allclose(found.columns_of("imu_acceleration_m_per_s2")[tick], expected, atol=2e-6)
        slope = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) @ heading / (12.0 * h)
        assert found.columns["imu_yaw_rate_rad_per_s"][tick] == pytest.approx(slope, abs=1e-7)
    assert np.abs(found.columns_of("imu_acceleration_m_per_s2")).max() > 2.0


def integrated(values: np.ndarray, step_s: float) -> np.ndarray:
    """Running integral by trapezoids."""
    halves = 0.5 * step_s * (values[1:] + values[:-1])
    return np.concatenate([np.zeros_like(values[:1]), np.cumsum(halves, axis=0)])


def test_integrating_a_noiseless_imu_twice_returns_the_path_of_its_place(tmp_path: Path) -> None:
    off = []
    for step_s in (0.002, 0.001):
        scene = sensed_scene(tmp_path, SINES, IDEAL, f"[run]\nduration_s = 2.0\nstep_s = {step_s}\n")
        found = simulate(scene, IMU_SIGNALS)
        heading = integrated(found.columns["imu_yaw_rate_rad_per_s"], step_s)
        world = turned(found.columns_of("imu_acceleration_m_per_s2"), heading + TURNED_RAD)
        path = AT - COM + integrated(integrated(world, step_s), step_s)  # it starts at rest
        true, _ = place_of(scene, np.array([0.0, 2.0]))
        off.append(float(np.linalg.norm(path[-1] - true[-1])))
        assert np.linalg.norm(true[-1] - true[0]) > 0.1
    assert off[1] < 2e-5
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.1)  # trapezoids: second order


def test_errors_and_delay_are_those_of_the_instrument(tmp_path: Path) -> None:
    quiet = "\n".join(line for line in ERRORS.splitlines() if "noise" not in line and "seed" not in line) + "\n"
    ideal = simulate(sensed_scene(tmp_path, SINES, IDEAL, RUN), IMU_SIGNALS)
    found = simulate(sensed_scene(tmp_path, SINES, IDEAL, quiet, "delay_s = 0.006\n", RUN), IMU_SIGNALS)
    true = ideal.columns_of("imu_acceleration_m_per_s2")
    delayed = np.concatenate([[true[0]] * 3, true[:-3]])
    expected = np.clip(delayed * (1.01, 0.98) + 0.05, -6.0, 6.0)
    np.testing.assert_allclose(found.columns_of("imu_acceleration_m_per_s2"), expected, rtol=1e-14, atol=1e-15)
    assert (np.abs(expected) == 6.0).any() or np.abs(expected).max() < 6.0
    yaw_rate = ideal.columns["imu_yaw_rate_rad_per_s"]
    np.testing.assert_allclose(found.columns["imu_yaw_rate_rad_per_s"][3:], 1.002 * yaw_rate[:-3] - 0.01, rtol=1e-12)


def test_a_seed_gives_the_same_noise_again_and_another_seed_another(tmp_path: Path) -> None:
    runs = [simulate(sensed_scene(tmp_path, IMU.replace("seed = 11", f"seed = {seed}"), "[run]\nduration_s = 20.0\n"
                                  "step_s = 0.002\n")).columns["imu_acceleration_m_per_s2[1]"] for seed in (5, 5, 6)]
    assert (runs[0] == runs[1]).all()
    assert (runs[0] != runs[2]).mean() > 0.99
    noise = runs[0] - 0.05  # at rest: bias, and 0.003 √(1/(2 · 2 ms))
    assert noise.std() == pytest.approx(0.003 * math.sqrt(250.0), rel=0.03)
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.03


def test_an_encoder_counts_the_turns_of_its_wheel_and_wraps(tmp_path: Path) -> None:
    found = simulate(sensed_scene(tmp_path, SINES, ENCODERS, "[run]\nduration_s = 4.0\nstep_s = 0.002\n"))
    for wheel, counts, gear in ((1, 4096, 1.0), (3, 360, -12.5)):
        column = found.columns[f"encoder_count[{wheel}]"]
        turned = np.floor(found.columns[f"wheel_angle_rad[{wheel}]"] * gear * counts / math.tau)
        assert column.dtype.kind == "i"
        assert np.abs(np.remainder(column - turned + 1, 65536) - 1).max() <= 1  # where a turn ends on an edge
        assert column.min() >= 0 and column.max() < 65536
        assert np.ptp(column) > 60000  # it has wrapped


@pytest.mark.parametrize("real", ["double", "single"])
def test_a_counter_of_32_bits_without_sign_shows_the_same_bits_from_0_on(tmp_path: Path, real: str) -> None:
    signed, unsigned = (simulate(sensed_scene(tmp_path, SINES, ENCODERS.replace("wrap = 65536\n", wrap),
                                              "[run]\nduration_s = 2.0\nstep_s = 0.002\n").with_run(real=real))
                        for wrap in ("", f"wrap = {2**32}\n"))
    for wheel in (1, 3):
        name = f"encoder_count[{wheel}]"
        before, after = signed.columns[name], unsigned.columns[name]
        assert before.min() < 0 and after.min() >= 0 and after.max() > 2**31
        assert (after == before % 2**32).all()


def test_sensors_change_no_bit_of_the_motion(tmp_path: Path) -> None:
    signals = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad", "energy_J")
    for inputs in (SINES, STEPS):
        with_sensors = simulate(sensed_scene(tmp_path, inputs, IMU, ENCODERS, RUN), (*signals, "encoder_count"))
        without = simulate(sensed_scene(tmp_path, inputs, RUN), signals)
        assert all((with_sensors.columns[name] == without.columns[name]).all() for name in without.columns)


def test_rows_of_every_tenth_step_show_what_all_rows_show(tmp_path: Path) -> None:
    every = simulate(sensed_scene(tmp_path, SINES, IMU, ENCODERS, RUN))
    tenth = simulate(sensed_scene(tmp_path, SINES, IMU, ENCODERS, "[outputs]\nevery_s = 0.02\n", RUN))
    assert all((tenth.columns[name] == every.columns[name][::10]).all() for name in tenth.columns)


def test_on_ground_with_friction_the_acceleration_is_the_change_of_velocity_over_the_step(tmp_path: Path) -> None:
    head = BODY.replace("com_x_m = 0.04\ncom_y_m = 0.03\n", "com_z_m = 0.1\n") + WHEELS
    scene = sensed_scene(tmp_path, STEPS, "[ground]\nfriction_coefficient = 0.5\n", RUN, head=head)
    found = simulate(scene, ("acceleration_body_m_per_s2", "velocity_body_m_per_s", "heading_rad"))
    velocity = turned(found.columns_of("velocity_body_m_per_s"), found.columns["heading_rad"])
    heading = found.columns["heading_rad"]
    mean = turned(np.diff(velocity, axis=0) / 0.002, -0.5 * (heading[1:] + heading[:-1]))
    assert np.abs(mean).max() > 0.5
    np.testing.assert_allclose(found.columns_of("acceleration_body_m_per_s2")[1:], mean, atol=1e-4)


def test_csv_and_json_have_counts_as_whole_numbers_and_replay_gives_them_again(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, out = sensed_scene(tmp_path, STEPS, IMU, ENCODERS, RUN), tmp_path / "run.csv"
    assert run(["simulate", str(scene.path), "--out", str(out), "--json"]) == 0
    final = json.loads(capsys.readouterr().out)["final"]
    assert isinstance(final["encoder_count[1]"], int)
    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["encoder_count[3]"]) for row in rows][-1] == final["encoder_count[3]"]
    assert float(rows[-1]["imu_yaw_rate_rad_per_s"]) == final["imu_yaw_rate_rad_per_s"]
    assert run(["replay", str(out), str(scene.path), "--json"]) == 0
    compared = json.loads(capsys.readouterr().out)["compared"]
    replayed = {each["signal"]: each["largest_difference"] for each in compared}
    assert set(rows[0]) - {"time_s"} == set(replayed)
    assert set(replayed.values()) == {0.0}


def test_the_picture_of_a_run_has_a_panel_for_each_kind_of_sensor(tmp_path: Path) -> None:
    from laconic.pictures.curves import sensor_panels

    assert sensor_panels(simulate(sensed_scene(tmp_path, RUN))) == []
    assert sensor_panels(simulate(sensed_scene(tmp_path, IMU, RUN))) == ["imu"]
    scene, picture = sensed_scene(tmp_path, STEPS, IMU, ENCODERS, RUN), tmp_path / "run.svg"
    assert sensor_panels(simulate(scene)) == ["imu", "encoders"]
    assert run(["simulate", str(scene.path), "--plot", str(picture)]) == 0
    text = picture.read_text(encoding="utf-8")
    assert "What the IMU shows" in text and "Encoders" in text


def test_single_precision_shows_the_same_within_its_rounding(tmp_path: Path) -> None:
    double = simulate(sensed_scene(tmp_path, SINES, IMU, ENCODERS, RUN))
    single = simulate(sensed_scene(tmp_path, SINES, IMU, ENCODERS, RUN + 'real = "single"\n'))
    for name in ("imu_acceleration_m_per_s2", "imu_yaw_rate_rad_per_s"):
        assert np.abs(single.columns_of(name)).max() > 0.1
        quiet = 6.0 * 0.003 * math.sqrt(250.0)  # the noise of single precision is another
        np.testing.assert_allclose(single.columns_of(name), double.columns_of(name), atol=2 * quiet)
    assert np.abs(single.columns["encoder_count[1]"] - double.columns["encoder_count[1]"]).max() <= 1
