"""PyPI odrive-can, unchanged, drives a scene: its client, its DBC and its decoder know nothing of us."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable
from typing import Any

import can
import pytest

from driven_scene import DrivenScene, driven_scene
from laconic.can.play.settings import drive_parameters, drive_settings
from laconic.can.play.vehicle import played
from laconic.can.rig.boards import emulated_node, why_no_emulation
from laconic.can.rig.lockstep import start_of
from laconic.can.rig.parameters import parameters_of
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT

odrive_can = pytest.importorskip("odrive_can", reason="odrive-can needs Python 3.11")
from odrive_can.odrive import CanMsg, DriveError, ODriveCAN  # noqa: E402

SCENE, WHEELS, TURN = "robomaster_mecanum", 4, 2.0 * math.pi  # its drives are nodes 1 to 4
SENT = ("Get_Version", "Heartbeat", "Get_Error", "Address", "Get_Encoder_Estimates", "Get_Iq", "Get_Temperature",
        "Get_Bus_Voltage_Current", "Get_Torques", "Get_Powers")
UNANSWERED = ("RxSdo", "TxSdo")  # endpoints: TxSdo cannot say no
DBC: Any = odrive_can.get_dbc()


class Client:
    """The four clients of a scene, each with an adapter that lets its axis through."""

    def __init__(self, scene: DrivenScene):
        self.scene = scene
        self.drives = [ODriveCAN(axis, can.Bus(interface="virtual", channel=scene.adapter(
            lambda message, axis=axis: message.arbitration_id >> 5 == axis))) for axis in range(1, WHEELS + 1)]

    async def __aenter__(self) -> Client:
        await self.scene.during(asyncio.gather(*(drive.start() for drive in self.drives)))
        return self

    async def __aexit__(self, *_: object) -> None:
        for drive in self.drives:
            drive._running = False  # else it waits a second for a message
        self.scene.step(100)
        for drive in self.drives:
            drive.stop()

    async def close_loop(self, control: str = "VELOCITY_CONTROL", inputs: str = "PASSTHROUGH") -> None:
        for drive in self.drives:
            drive.clear_errors()
            drive.set_controller_mode(control, inputs)
        await self.scene.during(asyncio.gather(*(each.set_axis_state("CLOSED_LOOP_CONTROL") for each in self.drives)))


@pytest.mark.parametrize("cycles", [2000, pytest.param(10_000, marks=pytest.mark.nightly)])
def test_odrive_can_drives_four_wheels_and_the_core_agrees_bit_for_bit(cycles: int):
    async def control(scene: DrivenScene) -> None:
        async with Client(scene) as client:
            await client.close_loop()
            for cycle in range(cycles):
                client.drives[cycle % WHEELS].set_input_vel(20.0 * math.sin(TURN * cycle / 5000.0))
                scene.step()
                await asyncio.sleep(0)
            for drive in client.drives:
                drive.check_errors()
                drive.set_input_vel(10.0)
            await scene.pass_time(2000)
            for drive in client.drives:
                values = await scene.during(drive.get_encoder_estimates())
                assert abs(values["Vel_Estimate"] - 10.0) < 0.05

    with driven_scene(SCENE, "odrive") as scene:
        asyncio.run(control(scene))
        assert scene.steps > cycles + 2000
        assert all(abs(scene.drive(wheel).wheel_angle_rad) > 1.0 for wheel in range(WHEELS))


def test_position_control_by_its_trajectory_ends_where_the_client_wants_the_wheels():
    async def control(scene: DrivenScene) -> None:
        async with Client(scene) as client:
            for drive in client.drives:
                drive.set_linear_count(0)  # a position in turns, for 0.6
                drive.set_traj_vel_limit(4.0)
                drive.set_traj_accel_limits(8.0, 8.0)
            await client.close_loop("POSITION_CONTROL", "TRAP_TRAJ")
            for drive in client.drives:
                drive.set_input_pos(3.0)
            await scene.pass_time(3000)
            for drive in client.drives:
                values = await scene.during(drive.get_encoder_estimates())
                assert abs(values["Pos_Estimate"] - 3.0) < 0.01
                assert abs(values["Vel_Estimate"]) < 0.02

    with driven_scene(SCENE, "odrive") as scene:
        asyncio.run(control(scene))


def test_a_silent_client_meets_the_watchdog_and_clears_it():
    async def control(scene: DrivenScene) -> None:
        async with Client(scene) as client:
            await client.close_loop()
            for _ in range(6):
                for drive in client.drives:
                    drive.set_input_vel(1.0)
                await scene.pass_time(50)
            await scene.pass_time(400)
            await scene.during(client.drives[0].wait_for_heartbeat())
            with pytest.raises(DriveError, match="WATCHDOG_TIMER_EXPIRED"):
                client.drives[0].check_errors()
            assert all(scene.drive(wheel).torque_Nm == 0.0 for wheel in range(WHEELS))  # they coast
            await client.close_loop()
            await scene.during(client.drives[0].wait_for_heartbeat())
            client.drives[0].check_errors()

    with driven_scene(SCENE, "odrive", watchdog_s=0.3) as scene:
        asyncio.run(control(scene))


class Asker:
    """Sends the messages of its DBC and decodes the answers with its decoder."""

    def __init__(self, scene: DrivenScene, axis: int):
        self.scene, self.axis, self.bus = scene, axis, can.Bus(interface="virtual", channel=scene.adapter())

    def tell(self, name: str, **values: float) -> None:
        message = DBC.get_message_by_name(f"Axis{self.axis}_{name}")
        zeros = {signal.name: 0 for signal in message.signals}
        self.bus.send(can.Message(arbitration_id=message.frame_id, is_extended_id=False,
                                  data=message.encode(zeros | values)))
        self.scene.answer()

    def ask(self, name: str) -> dict[str, Any]:
        message = DBC.get_message_by_name(f"Axis{self.axis}_{name}")
        while self.bus.recv(0) is not None:
            pass
        self.bus.send(can.Message(arbitration_id=message.frame_id, is_extended_id=False, is_remote_frame=True))
        self.scene.answer()
        while (answer := self.bus.recv(0)) is not None:
            decoded = CanMsg(answer)
            if (decoded.name, decoded.axis_id) == (name, self.axis):
                return decoded.data
        raise AssertionError(f"{name}: no answer")


def names_of_the_dbc() -> set[str]:
    return {message.name.split("_", 1)[1] for message in DBC.messages}


def test_every_message_of_its_dbc_is_decoded_and_right():
    with driven_scene(SCENE, "odrive") as scene:
        asker = Asker(scene, 3)
        torque_constant = scene.vehicle.settings.of_wheel(2)["torque_constant_Nm_per_A"]
        asked = {name: asker.ask(name) for name in SENT}
        assert asked["Get_Version"]["Protocol_Version"] == 2
        assert [asked["Get_Version"][f"Fw_Version_{each}"] for each in ("Major", "Minor", "Revision")] == [0, 6, 10]
        assert asked["Heartbeat"] == {"Axis_Error": "NONE", "Axis_State": "IDLE", "Procedure_Result": "SUCCESS",
                                      "Trajectory_Done_Flag": 1}
        assert asked["Get_Error"] == {"Active_Errors": "NONE", "Disarm_Reason": "NONE"}
        assert asked["Address"]["Node_ID"] == 3 and asked["Address"]["Serial_Number"] != 0
        assert asked["Get_Temperature"] == {"FET_Temperature": 25.0, "Motor_Temperature": 25.0}

        asker.tell("Set_Limits", Velocity_Limit=5.0, Current_Limit=8.0)
        asker.tell("Set_Vel_Gains", Vel_Gain=0.02, Vel_Integrator_Gain=0.1)
        asker.tell("Set_Pos_Gain", Pos_Gain=15.0)
        asker.tell("Set_Traj_Vel_Limit", Traj_Vel_Limit=2.0)
        asker.tell("Set_Traj_Accel_Limits", Traj_Accel_Limit=4.0, Traj_Decel_Limit=4.0)
        asker.tell("Set_Traj_Inertia", Traj_Inertia=0.001)
        asker.tell("Set_Absolute_Position", Position=12.5)
        assert abs(asker.ask("Get_Encoder_Estimates")["Pos_Estimate"] - 12.5) < 1e-6

        asker.tell("Set_Controller_Mode", Control_Mode=1, Input_Mode=1)
        asker.tell("Set_Axis_State", Axis_Requested_State=8)
        asker.tell("Set_Input_Torque", Input_Torque=0.02)
        scene.step(20)
        drive = scene.drive(2)
        assert asker.ask("Heartbeat")["Axis_State"] == "CLOSED_LOOP_CONTROL"
        assert abs(asker.ask("Get_Iq")["Iq_Measured"] * torque_constant - 0.02) < 1e-6
        assert abs(asker.ask("Get_Torques")["Torque_Estimate"] - 0.02) < 1e-6
        estimates = asker.ask("Get_Encoder_Estimates")
        assert abs(estimates["Vel_Estimate"] * TURN - drive.speed_rad_per_s) < 1e-5
        powers, bus = asker.ask("Get_Powers"), asker.ask("Get_Bus_Voltage_Current")
        assert abs(powers["Mechanical_Power"] - 0.02 * drive.speed_rad_per_s) < 1e-5
        assert abs(bus["Bus_Voltage"] * bus["Bus_Current"] - powers["Electrical_Power"]) < 1e-4

        asker.tell("Set_Controller_Mode", Control_Mode=2, Input_Mode=1)
        asker.tell("Set_Input_Vel", Input_Vel=1.25, Input_Torque_FF=0.5 * torque_constant)
        scene.step()
        assert abs(scene.drive(2).target_speed_rad_per_s - 1.25 * TURN) < 1e-5
        assert abs(scene.drive(2).target_current_A - 0.5) < 1e-6
        asker.tell("Set_Controller_Mode", Control_Mode=3, Input_Mode=1)
        asker.tell("Set_Input_Pos", Input_Pos=13.0, Vel_FF=0.5, Torque_FF=0.0)
        scene.step()
        assert abs(scene.drive(2).target_speed_rad_per_s - 0.5 * TURN) < 1e-5

        for name in ("RxSdo", "Enter_DFU_Mode"):
            asker.tell(name)
        assert asker.ask("Heartbeat")["Axis_State"] == "CLOSED_LOOP_CONTROL"
        asker.tell("Estop")
        assert asker.ask("Get_Error") == {"Active_Errors": "ESTOP_REQUESTED", "Disarm_Reason": "ESTOP_REQUESTED"}
        asker.tell("Clear_Errors")
        assert asker.ask("Heartbeat")["Axis_Error"] == "NONE"
        asker.tell("Reboot")
        assert asker.ask("Get_Encoder_Estimates")["Pos_Estimate"] == 0.0

        told = {"Set_Limits", "Set_Vel_Gains", "Set_Pos_Gain", "Set_Traj_Vel_Limit", "Set_Traj_Accel_Limits",
                "Set_Traj_Inertia", "Set_Absolute_Position", "Set_Controller_Mode", "Set_Axis_State",
                "Set_Input_Torque", "Set_Input_Vel", "Set_Input_Pos", "Enter_DFU_Mode", "Estop", "Clear_Errors",
                "Reboot"}
        assert names_of_the_dbc() == told | set(SENT) | set(UNANSWERED)


class Lent:
    """A bus that the client's destructor must not close."""

    def __init__(self, bus: can.BusABC):
        self._bus, self.channel_info = bus, bus.channel_info
        self.recv, self.send = bus.recv, bus.send

    def shutdown(self) -> None:
        """Left to its owner."""


@pytest.mark.nightly
@pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
def test_odrive_can_drives_a_board_that_has_no_other_protocol():
    """An emulated Cortex-M4F behind a serial line, 200 periods a second by its own clock."""
    async def control(bus: Any) -> float:
        drive = ODriveCAN(1, bus)
        await asyncio.wait_for(drive.start(), 5.0)
        drive.clear_errors()
        drive.set_controller_mode("VELOCITY_CONTROL", "PASSTHROUGH")
        await drive.set_axis_state("CLOSED_LOOP_CONTROL")
        speed = 0.0
        for _ in range(60):
            drive.set_input_vel(5.0)
            await asyncio.sleep(0.05)
            speed = (await drive.get_encoder_estimates())["Vel_Estimate"]
            if abs(speed - 5.0) < 0.1:
                break
        drive.check_errors()
        drive.stop()
        return speed

    scene = played(read_scene(SCENE).with_run(real="single", method=EXPLICIT, step_s=0.005))
    twin = scene.plant(scene.core())
    with emulated_node("an386-odrive") as client:
        client.open()
        settings = drive_settings(scene, "odrive")
        client.load_parameters([*parameters_of(twin, start_of(scene)), *drive_parameters(settings)], twin.core.dtype)
        client.control("START_DRIVES")
        assert abs(asyncio.run(control(Lent(client.link.bus))) - 5.0) < 0.1
        client.stop()


# ---- PyPI moteus, unchanged, drives a scene over its python-can transport.

moteus = pytest.importorskip("moteus")
Register, Mode = moteus.Register, moteus.Mode

MOTEUS_SCENE, IDS = "robomaster_mecanum", (1, 2, 3, 4)


def share(number: int) -> float:
    """Of a wheel's motion; a curve to the left, which four mecanum wheels can roll: 1 and 3 are left, 2 and 4 right."""
    return 1.0 if number % 2 else 1.5


class Wheels:
    """One client program for all wheels."""

    def __init__(self, scene: DrivenScene):
        self.scene = scene
        self.transport = moteus.PythonCan(interface="virtual", channel=scene.adapter())
        self.controllers = [moteus.Controller(id=each, transport=self.transport) for each in IDS]

    async def cycle(self, commands: list[Any]) -> dict[int, dict[int, float]]:
        """One cycle of the client, answered at once; what each wheel says."""
        task = asyncio.ensure_future(self.transport.cycle(commands))
        while not task.done():
            await asyncio.sleep(0)
            self.scene.answer()
        return {each.id: each.values for each in await task}

    async def command(self, make: Callable[[Any], Any], steps: int = 1) -> dict[int, dict[int, float]]:
        """The same command for each wheel, then steps."""
        values = await self.cycle([make(each) for each in self.controllers])
        self.scene.step(steps)
        return values


def run(control: Callable[[Wheels], Awaitable[None]], **numbers: float) -> int:
    async def all_of_it(scene: DrivenScene) -> None:
        wheels = Wheels(scene)
        await control(wheels)
        wheels.transport.close()

    with driven_scene(MOTEUS_SCENE, "moteus", **numbers) as scene:
        asyncio.run(all_of_it(scene))
        return scene.steps


def test_moteus_drives_four_wheels_and_the_core_agrees_bit_for_bit():
    async def control(wheels: Wheels) -> None:
        await wheels.command(lambda each: each.make_stop())
        for cycle in range(200):
            speed = 0.5 * math.sin(cycle / 50.0)
            values = await wheels.command(lambda each, speed=speed: each.make_position(
                position=math.nan, velocity=speed * share(each.id), maximum_torque=3.0, query=True), 20)
        assert {each[Register.MODE] for each in values.values()} == {Mode.POSITION}
        for _ in range(50):
            values = await wheels.command(lambda each: each.make_position(
                position=math.nan, velocity=0.5 * share(each.id), query=True), 20)
        for number, each in values.items():
            assert abs(each[Register.VELOCITY] - 0.5 * share(number)) < 0.01
            drive = wheels.scene.drive(number - 1)
            assert abs(each[Register.POSITION] * 2.0 * math.pi - drive.wheel_angle_rad) < 0.2

    assert run(control) >= 5_000


def test_its_client_moves_to_a_place_and_sees_when_the_trajectory_is_complete():
    async def control(wheels: Wheels) -> None:
        extra = moteus.QueryResolution()
        extra.trajectory_complete = moteus.INT8
        done: dict[int, dict[int, float]] = {}
        for _ in range(300):
            done = await wheels.command(lambda each: each.make_position(
                position=share(each.id), velocity=0.0, accel_limit=4.0, velocity_limit=1.0, query_override=extra), 20)
            if all(each[Register.TRAJECTORY_COMPLETE] for each in done.values()):
                break
        values = await wheels.command(lambda each: each.make_position(position=math.nan, query=True), 500)
        values = await wheels.command(lambda each: each.make_query())
        for number, each in values.items():
            assert abs(each[Register.POSITION] - share(number)) < 0.02

    run(control)


def test_a_silent_client_finds_the_timeout_mode_and_leaves_it_by_stop():
    async def control(wheels: Wheels) -> None:
        for _ in range(30):
            await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 20)
        wheels.scene.step(1500)
        values = await wheels.command(lambda each: each.make_query())
        assert {each[Register.MODE] for each in values.values()} == {Mode.TIMEOUT}
        assert all(abs(each[Register.VELOCITY]) < 0.05 for each in values.values())  # damped to rest
        assert all(wheels.scene.drive(number).unheard for number in range(4))  # for the verdict of play
        await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 5)
        values = await wheels.command(lambda each: each.make_stop(query=True))
        await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 5)
        values = await wheels.command(lambda each: each.make_query())
        assert {each[Register.MODE] for each in values.values()} == {Mode.POSITION}

    run(control)


def test_its_discovery_finds_every_drive_with_a_uuid_of_its_own():
    async def control(wheels: Wheels) -> None:
        task = asyncio.ensure_future(wheels.transport.discover(timeout=0.05))
        while not task.done():
            await asyncio.sleep(0.001)
            wheels.scene.answer()
        found = await task
        assert sorted(each.can_id for each in found) == list(IDS)
        assert len({bytes(each.uuid) for each in found}) == len(IDS)

    run(control)
