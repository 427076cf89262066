"""[sensors] of a scene: what it gives, and what is refused in one line that names the field and the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.simulation import simulate, usual_signals
from scene_text import BODY, ENCODERS, IMU, RUN, STEPS, WHEELS, sensed_scene

GOOD = BODY + WHEELS + STEPS + IMU + ENCODERS
PUCK = "[vehicle]\nmass_kg = 2.0\nyaw_inertia_kgm2 = 0.1\nwheel_radius_m = 0.5\n"


def test_a_scene_with_sensors_shows_them_besides_the_usual_signals(tmp_path: Path) -> None:
    scene, without = sensed_scene(tmp_path, IMU, ENCODERS, RUN), sensed_scene(tmp_path, RUN, name="bare")
    assert usual_signals(scene) == (*usual_signals(without), "imu_acceleration_m_per_s2[1]",
                                    "imu_acceleration_m_per_s2[2]", "imu_yaw_rate_rad_per_s", "encoder_count[1]",
                                    "encoder_count[3]")


def test_a_signal_without_its_index_stands_for_all_wheels_that_have_an_encoder(tmp_path: Path) -> None:
    outputs = '[outputs]\nsignals = ["encoder_count", "acceleration_body_m_per_s2"]\n'
    assert sensed_scene(tmp_path, ENCODERS, outputs, RUN).outputs.signals == (
        "encoder_count[1]", "encoder_count[3]", "acceleration_body_m_per_s2[1]", "acceleration_body_m_per_s2[2]")


def test_one_number_is_for_all_encoders_and_both_axes(tmp_path: Path) -> None:
    scene = sensed_scene(tmp_path, "[sensors.encoder]\ncounts_per_turn = 48\n", "[sensors.imu]\n"
                         "acceleration_bias_m_per_s2 = 0.5\n", RUN)
    assert scene.sensors.encoder == {"counts_per_turn": (48, 48, 48)}
    assert scene.sensors.imu == {"acceleration_bias_m_per_s2": (0.5, 0.5), "delay_s": 0.0}


def test_the_delay_is_a_time_so_it_stays_when_the_step_changes(tmp_path: Path) -> None:
    scene = sensed_scene(tmp_path, IMU, RUN)
    assert scene.delay_steps(scene.core()) == 3
    finer = scene.with_run(step_s=0.001)
    assert finer.delay_steps(finer.core()) == 6


REFUSED = {
    "empty table": ((IMU + ENCODERS, "[sensors]\n"), ("sensors.imu: is missing", "[sensors] out")),
    "unknown sensor": (("[sensors.imu]", "[sensors.lidar]"), ("sensors.lidar: is no known key",)),
    "unknown key": (("seed = 11", "sead = 11"), ("sensors.imu.sead: is no known key", "seed")),
    "no number": (("x_m = 0.15\n", 'x_m = "ahead"\n'), ("sensors.imu.x_m", "not a number")),
    "not finite": (("x_m = 0.15\n", "x_m = inf\n"), ("sensors.imu.x_m: infinity", "give a number")),
    "heading not finite": (("heading_deg = 30", "heading_deg = nan"), ("sensors.imu.heading_deg: NaN",)),
    "heading twice": (("heading_deg = 30", "heading_deg = 30\nheading_rad = 1"),
                      ("sensors.imu.heading_deg", "keep one")),
    "heading beyond counting": (("heading_deg = 30", "heading_rad = 1e300"), ("sensors.imu.heading_rad: ",)),
    "scale of three axes": (("[0.01, -0.02]", "[0.01, -0.02, 0]"),
                            ("sensors.imu.acceleration_scale_error: has 3 entries, not 2",)),
    "bias not finite": (("acceleration_bias_m_per_s2 = 0.05", "acceleration_bias_m_per_s2 = [0, nan]"),
                        ("sensors.imu.acceleration_bias_m_per_s2", "finite")),
    "negative noise": (("noise_m_per_s2_per_sqrt_Hz = 0.003", "noise_m_per_s2_per_sqrt_Hz = -1"),
                       ("sensors.imu.acceleration_noise_m_per_s2_per_sqrt_Hz: -1 is negative",)),
    "negative range": (("yaw_rate_range_rad_per_s = 9.0", "yaw_rate_range_rad_per_s = -9.0"),
                       ("sensors.imu.yaw_rate_range_rad_per_s: -9 is negative",)),
    "seed that is no whole number": (("seed = 11", "seed = 1.5"), ("sensors.imu.seed: is 1.5, not a whole number",)),
    "seed of more than 32 bits": (("seed = 11", "seed = 4294967296"), ("sensors.imu.seed: is 4294967296", "32 bits")),
    "seed without noise": ((IMU, "[sensors.imu]\nseed = 3\n"), ("sensors.imu.seed: has no effect without noise",)),
    "negative delay": (("delay_s = 0.006", "delay_s = -0.006"), ("sensors.imu.delay_s: is -0.006", "0 for none")),
    "delay inside a step": (("delay_s = 0.006", "delay_s = 0.005"),
                            ("sensors.imu.delay_s: 0.005 s is no whole number",)),
    "delay too long": (("delay_s = 0.006", "delay_s = 0.2"), ("sensors.imu.delay_s: 0.2 s are 100 steps", "64 steps")),
    "delay beyond counting": (("delay_s = 0.006", "delay_s = 1e300"), ("sensors.imu.delay_s", "shorter time")),
    "no counts": (("counts_per_turn = [4096, false, 360]\n", ""), ("sensors.encoder.counts_per_turn: is missing",)),
    "too few counts": (("[4096, false, 360]", "[4096, 360]"),
                       ("counts_per_turn: has 2 entries", "each of the 3 wheels")),
    "counts that are true": (("[4096, false, 360]", "[4096, true, 360]"),
                             ("counts_per_turn: is true, not a whole number",)),
    "counts in halves": (("[4096, false, 360]", "40.5"),
                         ("sensors.encoder.counts_per_turn: is 40.5, not a whole number",)),
    "no turn": (("[4096, false, 360]", "[4096, 0, 360]"), ("counts_per_turn: is 0", "false for none")),
    "too many counts": (("[4096, false, 360]", "3000000000"), ("counts_per_turn: is 3000000000", "32 bits")),
    "no encoder at all": (("[4096, false, 360]", "[false, false, false]"), ("gives no wheel an encoder",)),
    "too many gears": (("[1.0, -12.5]", "[1.0, 1.0, 1.0, 1.0]"),
                       ("gear_ratio: has 4 entries", "2, one for each encoder")),
    "no gear": (("[1.0, -12.5]", "0"), ("sensors.encoder.gear_ratio: is 0", "below 0")),
    "wrap of one": (("wrap = 65536", "wrap = 1"), ("sensors.encoder.wrap: is 1", "65536")),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_wrong_table_of_sensors_is_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (old, new), texts = REFUSED[name]
    assert old in GOOD
    path = tmp_path / "scene.toml"
    path.write_text(GOOD.replace(old, new) + RUN, encoding="utf-8")
    assert run(["simulate", str(path)]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert str(path) in line
    assert not [text for text in texts if text not in line], line


def test_encoders_need_wheels(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"sensors\.encoder\.counts_per_turn: .*has none; leave the encoders out"):
        sensed_scene(tmp_path, "[sensors.encoder]\ncounts_per_turn = 4\n", RUN, head=PUCK)


ASKED = {
    "imu_acceleration_m_per_s2": ("", "imu_acceleration_m_per_s2 is an IMU's", "give [sensors.imu]"),
    "imu_yaw_rate_rad_per_s": (ENCODERS, "imu_yaw_rate_rad_per_s is an IMU's", "give [sensors.imu]"),
    "encoder_count": (IMU, "encoder_count is an encoder's", "give [sensors.encoder]"),
    "encoder_count[1]": (IMU, "encoder_count[1] is an encoder's", "give [sensors.encoder]"),
    "encoder_count[2]": (ENCODERS, "wheel 2 has none", "sensors.encoder.counts_per_turn"),
    "encoder_count[4]": (ENCODERS, "does not match the vehicle's 3 wheels", "encoder_count[1] to encoder_count[3]"),
    "acceleration_body_m_per_s2[3]": (IMU, "there is no signal", "acceleration_body_m_per_s2"),
}


@pytest.mark.parametrize("signal", ASKED)
def test_a_signal_without_its_sensor_is_one_line_with_the_remedy(signal: str, tmp_path: Path) -> None:
    tables, *texts = ASKED[signal]
    with pytest.raises(BadInput) as refused:
        sensed_scene(tmp_path, tables, f'[outputs]\nsignals = ["{signal}"]\n', RUN)
    assert not [text for text in (*texts, "outputs.signals: ") if text not in str(refused.value)], refused.value
    with pytest.raises(BadInput) as refused:
        simulate(sensed_scene(tmp_path, tables, RUN), (signal,))
    assert not [text for text in texts if text not in str(refused.value)], refused.value
