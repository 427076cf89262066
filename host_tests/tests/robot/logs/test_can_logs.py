"""The log of a rig is read through a DBC: rounds of frames become rows, groups of wheels become wheels."""

from __future__ import annotations

import can
import numpy as np
import pytest

from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from laconic.robot.logs.column_map import MAPS
from laconic.robot.logs.for_vehicle import for_wheels

WHEELS, ROWS = 4, 40


def frame(name: str, **raw: int) -> can.Message:
    found = wire()[name]
    return can.Message(arbitration_id=ID_BASE + found.offset, data=found.pack(**raw), is_extended_id=False)


def written(path):
    """Four wheels in two groups, a pose and now and then a voltage."""
    with can.Logger(str(path)) as log:
        for k in range(ROWS):
            sent = [frame("POSE", x=2 * k, y=-k, heading=(100 * k + 31000) % 62832 - 31416),
                    frame("WHEEL_SPEED", group=0, wheel_speed_1=k, wheel_speed_2=-k, wheel_speed_3=7),
                    frame("WHEEL_SPEED", group=1, wheel_speed_1=3 * k)]
            if k % 10 == 0:
                sent.insert(0, frame("VOLTAGE", group=0, voltage_1=500))
            for number, message in enumerate(sent):
                message.timestamp = 1000.0 + 0.01 * k + 1e-4 * number
                log.on_message_received(message)
    return path


@pytest.mark.parametrize("ending", [".blf", ".asc"])
def test_a_rigs_log_becomes_rows_with_all_groups_of_wheels(ending, tmp_path):
    (log,), skipped = gather_logs([written(tmp_path / f"run{ending}")])
    log, k = for_wheels(log, [{}] * WHEELS), np.arange(ROWS)
    assert skipped == [] and log.map_name == "rig" and log.pose_point == "centre_of_mass"
    assert log.wheel_speed_rad_per_s == pytest.approx(0.005 * np.column_stack([k, -k, 7 + 0 * k, 3 * k]))
    assert log.pose[:, 0] == pytest.approx(0.002 * k)
    assert np.diff(log.pose[:, 2]) == pytest.approx(0.01 * np.ones(ROWS - 1), abs=1e-3)  # unwrapped
    assert np.diff(log.time_s) == pytest.approx(0.01 * np.ones(ROWS - 1), abs=2e-3)
    assert log.rotation_rad()[1, 0] == pytest.approx(0.005 * 1.5 * (log.time_s[2] - log.time_s[1]))


def test_wheels_that_the_scene_has_not_must_be_silent(tmp_path, capsys):
    path = written(tmp_path / "run.blf")
    assert run(["replay", str(path), "optiodom_omni3"]) == 2
    assert "has 6 wheels, the scene 3" in capsys.readouterr().err


WRONG = {
    "a message that is none": ("WHEEL_SPEED.", "WHEEL_SPEEDS.", "the DBC has no message 'WHEEL_SPEEDS'"),
    "a signal that is none": ("POSE.heading", "POSE.angle", "POSE has no signal 'angle'"),
    "a column without message": ('"POSE.x"', '"x"', "pose.columns: holds 'x'; give MESSAGE.signal"),
    "no DBC": ('dbc = "laconic.dbc"', "", "dbc: is missing"),
    "a DBC that is not there": ("laconic.dbc", "robot.dbc", "robot.dbc cannot be read"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=WRONG)
def test_a_map_that_the_dbc_does_not_know_is_one_line(old, new, words, tmp_path, capsys):
    path, mapped = written(tmp_path / "run.blf"), tmp_path / "map.toml"
    mapped.write_text((MAPS / "rig.toml").read_text().replace(old, new))
    assert run(["replay", str(path), "optiodom_omni4", "--map", str(mapped)]) == 2
    err = capsys.readouterr().err
    assert words in err and err.count("\n") == 1
