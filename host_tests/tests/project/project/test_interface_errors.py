"""What a Python program gives wrongly to the public interface is refused in one line that names it and the remedy."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laconic
import laconic.batch.memory
from laconic.base.outputs import write_text
from laconic.errors import BadInput
from laconic.scene.methods import EXPLICIT

ROBOT = {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.05}
MOTOR = {"resistance_ohm": 1.0, "torque_constant_Nm_per_A": 0.02, "back_emf_Vs_per_rad": 0.02, "gear_ratio": 12.0}
WHEEL = {"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0}


def scene() -> Any:
    return laconic.read_scene("s1")


def core() -> Any:
    return laconic.load_core("double")


def plant() -> Any:
    return core().plant(core().vehicle(ROBOT), EXPLICIT, 0.01)


def wheels() -> laconic.Vehicle:
    return laconic.Vehicle.of(laconic.read_scene("robotino2"))


def skids() -> laconic.Vehicle:
    return laconic.Vehicle.of(laconic.read_scene("skid_steer"))


def short_run() -> laconic.Trajectory:
    return laconic.simulate(scene().with_run(duration_s=0.1), ["x_m", "nu_rad_per_s"])


def whole_run() -> laconic.Trajectory:
    return laconic.simulate(scene().with_run(duration_s=0.1))


def in_itself() -> dict[str, Any]:
    tables: dict[str, Any] = {}
    tables["vehicle"] = tables
    return tables


def moved_wheel() -> laconic.Vehicle:
    vehicle = copy.deepcopy(laconic.read_scene("robotino2").vehicle)
    vehicle["wheel"][1]["x_m"] = 3.0
    return laconic.Vehicle(vehicle)


WRONG: list[tuple[Callable[[], Any], str]] = [
    (lambda: scene().with_run(step_s=0), "s1.toml: run.step_s: is 0; give a value above 0"),
    (lambda: scene().with_run(step_s=float("nan")), "s1.toml: run.step_s: is nan; give a finite number"),
    (lambda: scene().with_run(duration_s="3"), 's1.toml: run.duration_s: is the text "3", not a number'),
    (lambda: scene().with_run(method="nope"), "s1.toml: run.method: there is no 'nope'; known are auto"),
    (lambda: scene().with_run(real="dobule"), "s1.toml: run.real: there is no 'dobule'; did you mean double?"),
    (lambda: laconic.simulate(scene(), ["nope"]), "s1.toml: signals: there is no signal 'nope'"),
    (lambda: laconic.simulate(scene(), "x_m"), 's1.toml: signals: is the text "x_m", not a list'),  # type: ignore
    (lambda: laconic.simulate(scene(), ["x_m", "x_m"]), "s1.toml: signals: names x_m twice"),
    (lambda: laconic.simulate("s1"), "scene: 's1' is no Scene; give read_scene("),  # type: ignore[arg-type]
    (lambda: laconic.Vehicle.of("s1"), "scene: 's1' is no Scene; give read_scene("),  # type: ignore[arg-type]
    (lambda: laconic.Vehicle.of(None), "scene: None is no Scene; give read_scene("),  # type: ignore[arg-type]
    (lambda: laconic.Vehicle.of({}), "scene: {} is no Scene; give read_scene("),  # type: ignore[arg-type]
    (lambda: laconic.Filter("x", "y"), "plant: 'x' is no plant; make one with vehicle.plant("),  # type: ignore
    (lambda: plant().run(core().input(), True), "steps: True is no whole number"),
    (lambda: plant().run({"body_force_N": [1j, 1]}), "body_force_N: [1j, 1] is no number and no list of numbers"),
    (lambda: plant().run({"body_force_N": np.ones(2, bool)}), "is no number and no list of numbers; give real numbers"),
    (lambda: core().vehicle({"mass_kg": True}), "vehicle.mass_kg: True is no number"),
    (lambda: wheels().plant().sensors({"encoder": {"counts_per_turn": True}}),
     "sensors.encoder.counts_per_turn: is true, not a whole number"),
    (lambda: wheels().plant().sensors({"encoder": {"counts_per_turn": np.ma.masked}}),
     "sensors.encoder.counts_per_turn: is masked, not a whole number"),
    (lambda: plant().sensors({"encoder": {"counts_per_turn": 4}}), "counts turns of wheels, and the vehicle has none"),
    (lambda: wheels().plant(heading_rad=np.ma.masked), "heading_rad: masked is no number"),
    (lambda: wheels().linearise(heading_rad=np.ma.masked), "heading_rad: masked is no number"),
    (lambda: scene().with_run(step_s=np.ma.masked), "s1.toml: run.step_s: is masked, not a number"),
    (lambda: scene().with_run(step_s=np.ma.array(1.0, mask=True)), "s1.toml: run.step_s: is masked, not a number"),
    (lambda: laconic.read_scene(None), "scene: None is no path"),  # type: ignore[arg-type]
    (lambda: laconic.make_fmu("s1", "s1.fmu", version=3), "scene: 's1' is no Scene"),  # type: ignore[arg-type]
    (lambda: laconic.make_fmu(scene(), "s1.fmu", version=4), "version: there is no FMI 4; give 2 or 3"),
    (lambda: laconic.make_fmu(scene(), None, version=3), "out: None is no path"),  # type: ignore[arg-type]
    (lambda: laconic.make_fmu(scene(), "a\0b.fmu", version=2), r"out: 'a\x00b.fmu' is no path"),
    (lambda: plant().run(core().input(), 2.5), "steps: 2.5 is no whole number"),
    (lambda: plant().run(core().input(), -1), "steps: -1 steps cannot be taken"),
    (lambda: plant().run([1.0]), "input: [1.0] names no signal; give them by its name"),
    (lambda: plant().run({"voltage": [1]}), "voltage: there is no such input; did you mean voltage_V"),
    (lambda: plant().run(laconic.load_core("single").input()), "is no laconic_input of this core"),
    (lambda: plant().run_sampled(np.zeros((3, 3))), "samples: an array of shape (3, 3) and type float64 "),
    (lambda: plant().run_sampled(np.zeros((2, 3, core().input_length), complex)), "and type complex128 does not fit"),
    (lambda: plant().sensors().run_sampled("x"), "samples: 'x' does not fit; give real numbers of shape (steps, 3, "),
    (lambda: core().vehicle(ROBOT | {"motor": {}}), "vehicle.motor.resistance_ohm: is missing; give a number"),
    (lambda: laconic.Vehicle({}), "vehicle.mass_kg: is missing; give a number"),
    *((lambda key=key: laconic.Vehicle({each: ROBOT[each] for each in ROBOT if each != key}),
       f"vehicle.{key}: is missing; give a number") for key in ROBOT),
    *((lambda key=key: laconic.Vehicle(ROBOT | {"motor": {each: MOTOR[each] for each in MOTOR if each != key}}),
       f"vehicle.motor.{key}: is missing; give a number") for key in MOTOR),
    (lambda: laconic.Vehicle(ROBOT | {"wheel": [WHEEL, {"x_m": 1.0}]}), "vehicle.wheel[2].kind: is missing; give on"),
    (lambda: core().vehicle({"motor": None}), "vehicle.motor: None is no table"),
    (lambda: core().vehicle({"payload": None}), "vehicle.payload: None is no table"),
    (lambda: laconic.Vehicle(laconic.read_scene("robotino2").vehicle | {"motor_damping_Nms": 1.0}),
     "vehicle.motor_damping_Nms: is given besides vehicle.motor, from which it follows; keep one"),
    (lambda: core().vehicle({"wheel": [{"kind": ["omni"]}]}), "vehicle.wheel[1].kind: there is no ['omni']"),
    (lambda: core().vehicle({"wheel": [{"kind": "omni", "locked": 2}]}), "locked: 2 is neither True nor False"),
    *((lambda key=key, no=no: laconic.Vehicle(ROBOT | {"wheel": [WHEEL | {key: no}]}),
       f"vehicle.wheel[1].{key}: {no!r} is neither True nor False; give one of them")
      for key in ("locked", "driven") for no in (0, 1, 1.0, "yes", None)),
    (lambda: core().vehicle({"wheel": [{"kind": "omni", "motor_circuit": 1.5}]}), "motor_circuit: 1.5 is no whole"),
    (lambda: core().vehicle({"wheel": [{"kind": "omni", "motor_circuit": np.nan}]}), "motor_circuit: nan is no whole"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=[1, 2]), "wheel_speed_rad_per_s: [1, 2] is no list of 3 numbers"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=None), "wheel_speed_rad_per_s: None is no list of 3 numbers"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=[1, 2, 3]), "wheel_speed_rad_per_s: has no effect on ideal ground"),
    (lambda: laconic.analyse(scene(), parts=3), "parts: 3 is no list; give a list, such as ["),
    (lambda: laconic.analyse(scene(), at_s="1"), "at_s: '1' is no number; give one"),
    (lambda: laconic.analyse(scene(), at_s=1e9), "at_s: 1e+09 s lies outside the run; give 0 to "),
    (lambda: laconic.make_fmu(scene(), "s1.fmu", version=np.array([2])), "there is no FMI array([2])"),
    (lambda: laconic.build_scene(in_itself()), "scene: nests its tables too deeply, or one in itself; give those of"),
    (lambda: wheels().plant().sensors().restore(wheels().plant().sensors({"imu": {"seed": 3}}).save()),
     "sensors: were saved with another sensors.imu.seed; give what the save() of these gave"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=5.0), "wheel_speed_rad_per_s: 5.0 is no list of 3 numbers; give"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=np.array(5.0)), "wheel_speed_rad_per_s: array(5.) is no list of 3"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=(5.0 for _ in "ab")), "wheel_speed_rad_per_s: [5.0, 5.0] is no list"),
    (lambda: wheels().plant(wheel_speed_rad_per_s=b"abc"), "wheel_speed_rad_per_s: b'abc' is no list of 3 numbers"),
    (lambda: skids().plant(wheel_speed_rad_per_s=[1]), "wheel_speed_rad_per_s: [1] is no list of 4 numbers; give one"),
    (lambda: skids().plant(wheel_speed_rad_per_s=[1] * 5), "is no list of 4 numbers; give one"),
    (lambda: skids().plant(wheel_speed_rad_per_s=b"abcd"), "b'abcd' is no list of 4 numbers; give one"),
    (lambda: wheels().plant(nu_rad_per_s=b"abc"), "nu_rad_per_s: b'abc' is no list of 3 numbers; give one"),
    (lambda: wheels().plant(nu_rad_per_s=bytearray(b"abc")), "is no list of 3 numbers; give one"),
    (lambda: wheels().derivative(b"abc"), "nu_rad_per_s: b'abc' is no list of 3 numbers; give one"),
    (lambda: wheels().derivative({300, 2, 1}), "is no list of 3 numbers; give one"),
    (lambda: wheels().derivative({1: 1, 2: 2, 3: 3}), "{1: 1, 2: 2, 3: 3} is no list of 3 numbers"),
    (lambda: wheels().derivative(inputs={"voltage_V": bytearray(b"abc")}), "is no number and no list"),
    (lambda: wheels().plant(np.ma.array([1.0, 2, 3], mask=[0, 1, 0]), 0.01), "method: there is no masked_array("),
    (lambda: laconic.load_core(np.array(["double"])), "real: there is no array(['double']"),
    (lambda: wheels().plant().run(np.array(5.0)), 'array(5.) names no signal; give them by its name, such as {"volt'),
    (lambda: wheels().plant().step_derivatives({"voltage_V": [1, 2, 3]}).tangent(None, np.array(5.0)),
     'array(5.) names no signal; give them by its name, such as {"voltage_V": [5.0]}'),
    (lambda: wheels().plant().step_derivatives().jacobian("no"), "world_force: 'no' is neither True nor False; give"),
    *((lambda key=key: wheels().plant().sensors({"imu": {key: []}}), f"sensors.imu.{key}: has 0 entries; give one num")
      for key in ("x_m", "heading_rad", "seed", "delay_steps", "yaw_rate_range_rad_per_s")),
    (lambda: wheels().plant().sensors({"imu": {"acceleration_bias_m_per_s2": b"ab"}}), "b'ab' is no number; give one"),
    *((lambda key=key, no=no: laconic.make_fmu(scene(), "s1.fmu", version=3, **{key: no}),
       f"{key}: {no!r} is neither True nor False; give one of them")
      for key in ("scalar", "sources", "enumerations", "derivatives", "estimate") for no in ("no", float("nan"), 0)),
    *((lambda key=key: laconic.simulate(scene(), **{key: "no"}), f"{key}: 'no' is neither True nor False")
      for key in ("progress", "watched", "estimated")),
    (lambda: laconic.read_scene("/dev/zero"), "/dev/zero: has more than 16 MiB, which no scene needs; give the"),
    (lambda: laconic.Vehicle(ROBOT | {"wheel": [{"kind": "unset"}]}), "known are fixed, mecanum, omni, roller"),
    (lambda: laconic.Vehicle(ROBOT | {"wheel": [{"kind": "mecanum"}]}),
     "vehicle.wheel[1].roller_rad: is missing; give the angle between axle and rollers, such as 0.785398 (45°)"),
    (lambda: laconic.Vehicle(ROBOT | {"wheel": [{"kind": "roller"}]}), "vehicle.wheel[1].roller_rad: is missing"),
    (lambda: laconic.Vehicle(ROBOT | {"drive": {"supply_V": 5}}), "vehicle.drive.supply_V: limits a current through "
     "windings, and nothing gives their resistance; give vehicle.motor with its resistance_ohm"),
    (lambda: plant().set_step("x"), "step_s: 'x' is no number"),
    (lambda: plant().change(ROBOT), "is no laconic_vehicle of this core; make it with laconic.Vehicle("),
    (lambda: plant().restore(None, 3), "state: None is no laconic_state of this core; make it with plant.save()"),
    (lambda: core().plant(ROBOT, EXPLICIT, 0.01), "is no laconic_vehicle of this core"),
    (lambda: core().plant(core().vehicle(ROBOT), None, 0.01), "method: there is no None"),
    (lambda: core().plant(core().vehicle(ROBOT), "auto", 0.01, nu_rad_per_s=(1, 2)), "nu_rad_per_s: (1, 2) is no list"),
    (lambda: core().input([1, 2]), "input: [1, 2] is no mapping from signals to numbers"),
    (lambda: laconic.analyse(scene(), parts="geometry"), "parts: 'geometry' is one text; give a list, such as ["),
    (lambda: short_run().columns_of("wheel_sped"), "wheel_sped: there is no such signal; did you mean wheel_speed"),
    (lambda: short_run().columns_of("energy_J"), "energy_J: this run did not keep it; give simulate its name"),
    (lambda: core().vehicle([1]), "vehicle: [1] is no table"),
    (lambda: core().vehicle({"mass_kg": "1"}), "vehicle.mass_kg: '1' is no number"),
    (lambda: core().vehicle({"wheel": {"x_m": 1}}), "vehicle.wheel: {'x_m': 1} is no list"),
    (lambda: core().vehicle({"wheel": [{}]}), "vehicle.wheel[1].kind: is missing; give one of fixed, mecanum, omni, "),
    (lambda: core().vehicle({"wheel": [{"kind": "omni", "xm": 1}]}), "vehicle.wheel[1].xm: unknown key; did you mean"),
    (lambda: core().vehicle({"support": [{"x_m": 1}]}), "vehicle.support[1].y_m: is missing; give a number"),
    (lambda: core().vehicle({"payload": {"mass": 1}}), "vehicle.payload.mass: unknown key; did you mean mass_kg?"),
    (lambda: core().vehicle({"motor": {"gears": 1}}), "vehicle.motor.gears: unknown key"),
    (lambda: laconic.plot("x"), "run: 'x' is no run; give what laconic.simulate(scene) returns"),  # type: ignore
    (lambda: laconic.plot(None), "run: None is no run; give what"),  # type: ignore[arg-type]
    (lambda: laconic.plot(scene()), "is no run; give what laconic.simulate(scene) returns"),  # type: ignore[arg-type]
    (lambda: short_run().columns_of(None), "name: None is no name of a signal; give one"),  # type: ignore[arg-type]
    (lambda: laconic.load_core(None), "real: there is no None; known are double, single"),  # type: ignore[arg-type]
    (lambda: laconic.load_core([3]), "real: there is no [3]; known are double, single"),  # type: ignore[arg-type]
    (lambda: laconic.make_fmu(scene(), "s1.fmu", version=2.0), "there is no FMI 2.0; give 2 or 3"),  # type: ignore
    (lambda: laconic.make_fmu(scene(), "nowhere/s1.txt", version=2), "s1.txt: cannot be a .txt file; choose a name"),
    (lambda: wheels().plant().run([6, -3, 2]), 'by its name, such as {"voltage_V": [6, -3, 2]}'),
    (lambda: wheels().plant().run({"voltage_V": np.ones((3, 1))}), "numbers of shape (3, 1) are not its numbers, of "
                                                                   "which there are 3; give them in one row"),
    (lambda: wheels().plant().run({"voltage_V": np.ma.array([1, 2, 3], mask=[0, 1, 0])}), "is no number and no list"),
    (lambda: core().input_row({"voltage_V": [1, 2], "voltage_V[1]": 5}, 2), "voltage_V[1]: is given besides voltage_V"),
    (lambda: wheels().derivative([1, 2, float("nan")]), "nu_rad_per_s[3]: nan is not finite"),
    (lambda: wheels().linearise(heading_rad=float("inf")), "heading_rad: inf is not finite"),
    (lambda: wheels().derivative(inputs={"voltage_V[2]": float("nan")}), "voltage_V: nan is not finite"),
    (lambda: plant().change(laconic.Vehicle(ROBOT, "single")), "vehicle: is in single precision, and this is in "),
    (lambda: laconic.load_core("single").check_vehicle(wheels()), "vehicle: is in double precision, and this is in "),
    (lambda: plant().change(wheels()), "vehicle: has 3 wheels, and the plant 0; make a plant of it"),
    (lambda: wheels().plant().change(moved_wheel()), "vehicle.wheel[2].x_m: is 3, and the plant's -0.125; wheels stay"),
    (lambda: laconic.plot(whole_run(), ""), "path: '' is no path; give one as text or as a Path"),
    (lambda: laconic.plot(whole_run(), "."), "path .: is a folder; give the name of a file in it that ends in .png"),
    (lambda: laconic.plot(whole_run(), Path("/")), "path /: is a folder; give the name of a file in it"),
    (lambda: laconic.plot(whole_run(), f"{__file__}/run.png"), f"run.png: cannot be written ({__file__} is no folder)"),
    (lambda: laconic.make_fmu(scene(), "", version=2), "out: '' is no path"),
    (lambda: laconic.make_fmu(scene(), f"{__file__}/f.fmu", version=2), f"cannot be written ({__file__} is no folder)"),
    (lambda: write_text(Path(__file__) / "text", ""), "text: cannot be written (not a directory); choose another path"),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("call, message", WRONG, ids=[message for _, message in WRONG])
def test_a_wrong_argument_is_refused_in_one_line_by_its_name(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(BadInput) as refused:
        call()
    assert message in str(refused.value)


def test_a_vehicle_is_taken_wherever_one_is_asked_for() -> None:
    moving, heavier = wheels().plant(step_s=0.01), laconic.read_scene("robotino2").vehicle | {"mass_kg": 30.0}
    robot = laconic.Vehicle(heavier)
    moving.run({"voltage_V": [6, -3, 2]}, 10)
    moving.change(robot)
    assert moving.c.vehicle.mass_kg == 30.0
    core().check_vehicle(robot)
    assert core().matrices(robot).inertia.tolist() == robot.matrices().inertia.tolist()
    assert core().plant(robot, EXPLICIT, 0.01).wheel_count == core().prepare(robot).wheel_count == 3


def test_a_batch_that_memory_does_not_hold_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def empty(*_: Any) -> Any:
        raise MemoryError

    monkeypatch.setattr(np, "empty", empty)
    with pytest.raises(BadInput, match=r"lanes: so many need 1.5 GiB of memory, which are not there; give fewer"):
        laconic.batch.memory.aligned_memory(3 * 2**29)


def test_columns_of_a_signal_are_all_of_them_or_the_one_that_is_named() -> None:
    run = short_run()
    assert run.columns_of("nu_rad_per_s").shape == (len(run.time_s), 3)
    assert run.columns_of("nu_rad_per_s[2]").ravel().tolist() == run.columns["nu_rad_per_s[2]"].tolist()


def test_a_run_shows_itself_in_one_line() -> None:
    shown = repr(short_run())
    assert shown.startswith("<run of ") and shown.endswith(" rows to 0.1 s of x_m, nu_rad_per_s>") and len(shown) < 200


def test_a_pose_shows_its_numbers() -> None:
    pose = plant().pose
    assert isinstance(pose, laconic.Pose)
    assert str(pose).startswith("Pose(x_m=0.0, y_m=0.0, heading_rad=0.0, ")


def test_numbers_of_numpy_are_numbers() -> None:
    run = scene().with_run(step_s=np.float32(0.25), duration_s=np.int64(3)).run
    assert (run.step_s, run.duration_s) == (0.25, 3.0)
    one = plant()
    one.run(core().input(), np.uint8(3))
    assert one.steps == 3


def test_a_signal_without_its_index_stands_for_all_of_them() -> None:
    found = laconic.simulate(scene().with_run(duration_s=0.1), ["x_m", "nu_rad_per_s", "voltage_V"]).columns
    assert [*found][:4] == ["x_m", "nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]"]
    assert len(found) == 4 + scene().wheel_count


def test_an_fmu_is_written_to_a_path_that_is_text(tmp_path: Path) -> None:
    assert laconic.make_fmu(scene(), str(tmp_path / "s1.fmu"), version=2).stat().st_size > 1000
