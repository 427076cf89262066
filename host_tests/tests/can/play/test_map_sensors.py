"""laconic play --dbc --map: a scene's IMU and encoders are outputs that any DBC's signals can carry."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run
from laconic.core import load
from laconic.scene import read_scene
from play_support import DBC, PLAY, Codec, played

SENSORS = """
[sensors.imu]
x_m = 0.05
acceleration_noise_m_per_s2_per_sqrt_Hz = 1e-3
seed = 3

[sensors.encoder]
counts_per_turn = 1024
gear_ratio = 10
wrap = 4096
"""
WHEEL_STATE = 0x220
FROM = {"CountLeft": "encoder_count[1]", "SpeedLeft": "imu_acceleration_m_per_s2[1]",
        "SpeedRight": "imu_yaw_rate_rad_per_s"}
MAP = '''[[receive]]
message = "WHEEL_COMMAND"

[[receive.signal]]
name = "VoltageLeft"
to = "voltage_V[1]"

[[receive.signal]]
name = "VoltageRight"
to = "voltage_V[2]"

[[send]]
message = "WHEEL_STATE"
period_s = 0.01
pages = "together"
''' + "".join(f'\n[[send.signal]]\nname = "{name}"\nfrom = "{source}"\n' for name, source in FROM.items())


def written(folder: Path, sensors: str, text: str = MAP) -> tuple[Path, Path]:
    """A scene with these sensors, and the map."""
    scene, signal_map = folder / "sensing.toml", folder / "map.toml"
    scene.write_text((SOURCE_DIR / "scenes" / "turtlebot3_burger.toml").read_text(encoding="utf-8") + sensors,
                     encoding="utf-8")
    signal_map.write_text(text, encoding="utf-8")
    return scene, signal_map


def test_signals_carry_what_the_cores_sensors_show(tmp_path: Path) -> None:
    path, signal_map = written(tmp_path, SENSORS)
    codec, scene, core = Codec(), read_scene(path), load("double")
    judgement, controller = played(path, 1.0, lambda t: [codec.command(5.5, 10.0)], dbc=DBC, map_path=signal_map)
    assert judgement.exit_status == 0, judgement
    plant = scene.plant(core)
    sensors, held = scene.sensors_of(plant), plant.input_of({"voltage_V": [5.5, 10.0]})
    seen, greatest = set(), 0.0
    for time_s, message in controller.of(WHEEL_STATE)[3:60]:
        values = codec.decode(message)
        sensors.run(held, round(time_s / scene.run.step_s) - plant.steps)
        shown = sensors.read(held)
        greatest = max(greatest, abs(shown.imu_acceleration_m_per_s2[0]))
        if values["Page"] == 0:
            assert values["CountLeft"] == shown.encoder_count[0]
        elif values["Page"] == 2:
            assert abs(values["SpeedLeft"] - shown.imu_acceleration_m_per_s2[0]) <= 0.005 + 1e-9
            assert abs(values["SpeedRight"] - shown.imu_yaw_rate_rad_per_s) <= 0.005 + 1e-9
        seen.add(values["Page"])
    assert {0, 2} <= seen and greatest > 0.1 and shown.encoder_count[0] > 100


@pytest.mark.parametrize("sensors, said", [
    ("", "encoder_count[1] is an encoder's, and the scene has none; give [sensors.encoder]"),
    ("[sensors.encoder]\ncounts_per_turn = 64\n", "imu_acceleration_m_per_s2[1] is an IMU's")])
def test_a_sensor_that_the_scene_lacks_is_refused_by_name(
        tmp_path: Path, sensors: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    scene, signal_map = written(tmp_path, sensors)
    status = run(["play", str(scene), "--dbc", str(DBC), "--map", str(signal_map), "--listen", "0", "--duration", "1"])
    text = capsys.readouterr().err
    assert status == 2 and said in text and text.count("\n") == 1


def test_a_drives_count_is_not_a_wheels_encoder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (PLAY / "transporter_drives.toml").read_text(encoding="utf-8").replace("drive_count[1]", "encoder_count[1]")
    _, signal_map = written(tmp_path, "", text)
    status = run(["play", "robotino2", "--dbc", str(DBC), "--map", str(signal_map), "--listen", "0",
                  "--duration", "1"])
    assert status == 2 and "that of the motor's drive is drive_count" in capsys.readouterr().err
