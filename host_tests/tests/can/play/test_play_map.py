"""laconic play --dbc --map: signals of any DBC join the model's inputs and outputs."""

from __future__ import annotations

from functools import reduce

import can
import numpy as np

from laconic.core import load
from laconic.scene import read_scene
from play_support import DBC, PLAY, Codec, played

MAP = PLAY / "transporter.toml"
SCENE = "turtlebot3_burger"
WITH_MAP = {"dbc": DBC, "map_path": MAP}
WHEEL_STATE, SHORT_SPEED = 0x220, 0x221
POSE = 0x18FF50E5


def twin_after(steps: int, left_V: float, right_V: float, from_step: int):
    """The core alone: the voltages act from a step on."""
    scene, core = read_scene(SCENE), load("double")
    plant = scene.plant(core)
    row = np.zeros(core.input_length)
    start = core.input_fields["voltage_V"][0]
    for step in range(steps):
        if step == from_step:
            row[start : start + 2] = left_V, right_V
        plant.run(core.input(row))
    return plant


def test_a_dbc_with_motorola_order_multiplexers_and_signed_signals_drives_a_scene():
    codec = Codec()
    judgement, controller = played(SCENE, 1.0, lambda t: [codec.command(5.5, -10.0)], **WITH_MAP)
    assert judgement.exit_status == 0, judgement
    states = [(t, codec.decode(message)) for t, message in controller.of(WHEEL_STATE)]
    assert [values["Page"] for _, values in states[:6]] == [0, 1, 2, 0, 1, 2]
    step_s = read_scene(SCENE).run.step_s
    for time_s, values in states[3:60]:
        steps = round(time_s / step_s)
        plant = twin_after(steps, 5.5, 10.0, 0)
        angles, speeds = plant.wheel_angles(), plant.wheel_speeds()
        if values["Page"] == 0:
            assert values["CountLeft"] == int(np.floor(angles[0] / (2 * np.pi) * 40960)) % 65536
        elif values["Page"] == 1:
            assert values["CountRight"] == int(np.floor(-angles[1] / (2 * np.pi) * 4096)) % 1000
        else:
            assert abs(values["SpeedLeft"] - speeds[0]) <= 0.005 + 1e-9
            assert abs(values["SpeedRight"] + speeds[1]) <= 0.005 + 1e-9
    assert states[-1][1]["Page"] is not None and abs(speeds[0]) > 1.0


def test_counters_and_checksums_of_sent_messages_are_those_of_the_map():
    codec = Codec()
    _, controller = played(SCENE, 0.5, lambda t: [codec.command(3.0, 3.0)], **WITH_MAP)
    frames = [message for _, message in controller.of(WHEEL_STATE)]
    assert [codec.decode(each)["Alive"] for each in frames] == [count % 15 for count in range(len(frames))]
    assert all(reduce(lambda a, b: a ^ b, each.data[:7]) == each.data[7] for each in frames)


def test_a_message_is_sent_when_it_is_asked_for_by_another_or_by_a_remote_frame():
    codec = Codec()

    def commands(t: float) -> list[can.Message]:
        remote = can.Message(arbitration_id=SHORT_SPEED, is_extended_id=False, is_remote_frame=True, dlc=4)
        asks = [codec.encode("ASK_POSE", What=1), remote] if abs(t - 0.3) < 1e-6 else []
        return [codec.command(2.0, -4.0), *asks]

    judgement, controller = played(SCENE, 0.5, commands, **WITH_MAP)
    (_, pose), = controller.of(POSE)
    (_, speed), = controller.of(SHORT_SPEED)
    assert pose.is_extended_id
    plant = twin_after(round(0.3 / read_scene(SCENE).run.step_s), 2.0, 4.0, 0)
    values = codec.decode(pose)
    assert abs(values["X"] - plant.pose.origin_x_m) <= 0.0005 + 1e-9
    assert abs(values["Heading"] - np.degrees(plant.pose.heading_wrapped_rad)) <= 0.005 + 1e-9
    assert abs(codec.decode(speed)["Speed"] - plant.body_velocity()[0][0]) <= 0.005 + 1e-9
    assert speed.data[1] == ~(sum(speed.data) - speed.data[1]) & 255 and codec.decode(speed)["Real"] == -2
    assert judgement.figures["late_periods"] == 0


def test_frames_with_a_wrong_checksum_a_wrong_count_or_no_whole_length_move_nothing():
    codec, spoilt = Codec(), {0.2: {"spoil": 1}, 0.3: {"step": 0}, 0.4: {"step": 5}}

    def commands(t: float) -> list[can.Message]:
        how = next((each for at, each in spoilt.items() if abs(t - at) < 1e-6), {})
        message = codec.command(32.0 if how else 4.0, 4.0, **how)
        short = can.Message(arbitration_id=0x120, is_extended_id=False, data=message.data[:5])
        return [message, short] if abs(t - 0.1) < 1e-6 else [message]

    judgement, controller = played(SCENE, 0.5, commands, **WITH_MAP)
    assert {note.partition(", ")[2] for note in judgement.notes} == {
        "WHEEL_COMMAND: wrong checksum", "WHEEL_COMMAND: repeated", "WHEEL_COMMAND: wrong count",
        "WHEEL_COMMAND: wrong length or page"}
    last = [codec.decode(each) for _, each in controller.of(WHEEL_STATE)][-10:]
    speeds = [values["SpeedLeft"] for values in last if "SpeedLeft" in values]
    plant = twin_after(round(0.5 / read_scene(SCENE).run.step_s), 4.0, -4.0, 0)
    assert abs(speeds[-1] - plant.wheel_speeds()[0]) < 0.02


def test_the_vehicle_coasts_to_rest_when_the_commands_cease_and_the_watchdog_is_a_verdict():
    codec = Codec()
    judgement, controller = played(SCENE, 2.0, lambda t: [codec.command(6.0, -6.0)] if t < 0.5 else [], **WITH_MAP)
    assert judgement.exit_status == 1
    verdict, = [each for each in judgement.verdicts if not each.passed]
    assert verdict.name == "watchdog" and "WHEEL_COMMAND" in verdict.detail
    speeds = [(t, codec.decode(each)["SpeedLeft"]) for t, each in controller.of(WHEEL_STATE)
              if "SpeedLeft" in codec.decode(each)]
    assert max(speed for t, speed in speeds if t < 0.6) > 3.0
    assert abs(speeds[-1][1]) < 0.01


def test_signals_that_are_targets_of_drives_go_through_the_drives_c_code():
    codec = Codec()
    pages = ({"Page": 0, "SpeedLeft": 600.0}, {"Page": 1, "SpeedRight": -300.0})

    def commands(t: float) -> list[can.Message]:
        return [codec.encode("DRIVE_COMMAND", Enable=t >= 0.5, **page) for page in pages]

    judgement, controller = played("robotino2", 3.0, commands, dbc=DBC, map_path=PLAY / "transporter_drives.toml")
    assert judgement.exit_status == 0, judgement
    states = [(t, codec.decode(message)) for t, message in controller.of(WHEEL_STATE)]
    left = [(t, values["SpeedLeft"]) for t, values in states if "SpeedLeft" in values]
    assert all(speed == 0.0 for t, speed in left if t < 0.5)  # not enabled
    rad_per_s = 2 * np.pi / 60 / 16  # of a wheel for one rpm of the shaft
    assert abs(left[-1][1] - 600.0 * rad_per_s) < 0.02
    right = [values["SpeedRight"] for _, values in states if "SpeedRight" in values]
    assert abs(right[-1] + 300.0 * rad_per_s) < 0.02
    counts = [(t, values["CountLeft"]) for t, values in states if "CountLeft" in values]
    (before_s, before), (after_s, after) = counts[-2:]
    assert abs((after - before) % 65536 - 10.0 * 4096 * (after_s - before_s)) <= 2


def test_a_brake_by_script_holds_the_wheel_of_a_maps_drive_which_then_stalls_until_it_is_let_go():
    codec = Codec()
    pages = ({"Page": 0, "SpeedLeft": 600.0}, {"Page": 1, "SpeedRight": -300.0})

    def commands(t: float) -> list[can.Message]:
        return [codec.encode("DRIVE_COMMAND", Enable=True, **page) for page in pages]

    judgement, controller = played("robotino2", 3.0, commands, dbc=DBC, map_path=PLAY / "transporter_drives.toml",
                                   faults=("stall:1@1+1",))
    assert judgement.exit_status == 0, judgement
    wheel = {name: [(t, values[name]) for t, values in
                    ((t, codec.decode(message)) for t, message in controller.of(WHEEL_STATE)) if name in values]
             for name in ("SpeedLeft", "SpeedRight")}
    rad_per_s = 2 * np.pi / 60 / 16
    assert all(abs(speed) < 1e-3 for t, speed in wheel["SpeedLeft"] if 1.02 < t < 1.98)
    assert all(abs(speed + 300.0 * rad_per_s) < 0.3 for t, speed in wheel["SpeedRight"] if 1.5 < t < 1.98)
    assert max(speed for t, speed in wheel["SpeedLeft"] if t > 2.02) > 600.0 * rad_per_s / 2  # it is let go
