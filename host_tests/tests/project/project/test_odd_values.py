"""Whatever a program passes as one argument of the public interface is taken, or refused in one short line."""

from __future__ import annotations

import datetime
import decimal
import fractions
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.errors import LaconicError

LONGEST = 1500  # letters of a line; lists of known names are the longest


class Faulty:
    """Fails whatever it is asked."""

    def __repr__(self) -> str:
        raise RuntimeError("no words")

    def __float__(self) -> float:
        raise RuntimeError("no number")


def deep(levels: int) -> list[Any]:
    found: list[Any] = []
    for _ in range(levels):
        found = [found]
    return found


ODD: dict[str, Callable[[], Any]] = {
    "a number of thousands of digits": lambda: 10**5000, "minus such a number": lambda: -(10**5000),
    "a list of such numbers": lambda: [10**5000] * 3, "a mapping to such a number": lambda: {"mass_kg": 10**5000},
    "a million letters": lambda: "x" * 10**6, "a key of a million letters": lambda: {"x" * 10**6: 1},
    "a list of a million letters": lambda: ["x" * 10**6], "a million words": lambda: "x " * 500_000,
    "a path of a million parts": lambda: "x/" * 500_000, "a name with a zero": lambda: "a\0b",
    "half of a pair": lambda: "\ud800", "lines": lambda: "a\nb\r\n", "no letters": lambda: "",
    "a view of bytes": lambda: memoryview(b"abc"), "bytes": lambda: b"abc", "many bytes": lambda: bytearray(10**6),
    "NaN": lambda: float("nan"), "infinity": lambda: float("inf"), "a complex number": lambda: 1j,
    "a fraction": lambda: fractions.Fraction(1, 3), "a decimal": lambda: decimal.Decimal("NaN"),
    "a day": lambda: datetime.date(2020, 1, 1), "NumPy's time": lambda: np.datetime64("NaT"),
    "nothing": lambda: None, "true": lambda: True, "an object": object, "a class": lambda: int,
    "a function": lambda: len, "a faulty object": Faulty, "a list of them": lambda: [Faulty()] * 3,
    "a set": lambda: {1, 2, 3}, "a generator": lambda: (each for each in (1, 2, 3)), "a range": lambda: range(3),
    "nested lists": lambda: deep(5000), "ragged lists": lambda: [[1, 2], [3]], "no list": list, "no mapping": dict,
    "masked": lambda: np.ma.masked, "an array of objects": lambda: np.array([None, 1, "x"], object),
    "an array of no numbers": lambda: np.zeros((0, 3)), "a mapping from numbers": lambda: {1: 2},
    "a mapping from a faulty object": lambda: {"x": Faulty()},
}
ROBOT = {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.01,
         "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.1}
WHEEL = {"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0}
RUN = {"duration_s": 0.1, "step_s": 0.01}


@cache
def scene(name: str) -> laconic.Scene:
    return laconic.read_scene(name)


@cache
def robot() -> laconic.Vehicle:
    return laconic.Vehicle.of(scene("robotino2"))


def plant() -> laconic.Plant:
    return robot().plant(step_s=0.01)


def batch() -> laconic.Batch:
    return laconic.Batch(robot(), 4)


@cache
def hinged() -> laconic.ArticulatedVehicle:
    return laconic.ArticulatedVehicle.of(scene("mir_like"))


def hinged_batch() -> laconic.ArticulatedBatch:
    return laconic.ArticulatedBatch(hinged(), 4)


def kept() -> laconic.Filter:
    return laconic.Filter(plant(), {"encoder_std_rad": 0.01, "yaw_rate_std_rad_per_s": 0.01})


def scene_with(table: str, key: str, odd: Any) -> laconic.Scene:
    tables: dict[str, Any] = {"vehicle": ROBOT | {"wheel": [WHEEL]}, "run": RUN}
    return laconic.build_scene(tables | {table: tables.get(table, {}) | {key: odd}})


SHORT: dict[str, Callable[[Any], Any]] = {
    "read_scene": laconic.read_scene, "build_scene": laconic.build_scene,
    "build_scene's name": lambda odd: laconic.build_scene({"name": odd, "vehicle": ROBOT, "run": RUN}),
    "build_scene's source": lambda odd: laconic.build_scene({"source": odd, "vehicle": ROBOT, "run": RUN}),
    "build_scene's table": lambda odd: laconic.build_scene({"vehicle": odd, "run": RUN}),
    "build_scene's unknown table": lambda odd: laconic.build_scene({"vehicle": ROBOT, "run": RUN, "x": odd}),
    "build_scene's run": lambda odd: laconic.build_scene({"vehicle": ROBOT, "run": odd}),
    "build_scene's wheels": lambda odd: laconic.build_scene({"vehicle": ROBOT | {"wheel": odd}, "run": RUN}),
    "build_scene's inputs": lambda odd: laconic.build_scene({"vehicle": ROBOT, "run": RUN, "input": odd}),
    "build_scene's outputs": lambda odd: scene_with("outputs", "signals", odd),
    "build_scene's mass": lambda odd: scene_with("vehicle", "mass_kg", odd),
    "build_scene's step": lambda odd: scene_with("run", "step_s", odd),
    "build_scene's method": lambda odd: scene_with("run", "method", odd),
    "build_scene's base": lambda odd: scene_with("rig", "id_base", odd),
    "build_scene's seed": lambda odd: scene_with("sensors", "imu", {"seed": odd, "yaw_rate_noise_rad_per_s_per_sqrt_Hz":
                                                                     0.1}),
    "build_scene's counts": lambda odd: scene_with("sensors", "encoder", {"counts_per_turn": odd}),
    "with_run's method": lambda odd: scene("s1").with_run(method=odd),
    "with_run's step": lambda odd: scene("s1").with_run(step_s=odd),
    "with_run's real": lambda odd: scene("s1").with_run(real=odd),
    "with_run's duration": lambda odd: scene("s1").with_run(duration_s=odd),
    "load_core": laconic.load_core, "simulate": laconic.simulate,
    "simulate's signals": lambda odd: laconic.simulate(scene("s1").with_run(duration_s=0.1), odd),
    "Vehicle": laconic.Vehicle, "Vehicle.of": laconic.Vehicle.of,
    "Vehicle's real": lambda odd: laconic.Vehicle(ROBOT, odd),
    "Vehicle's mass": lambda odd: laconic.Vehicle(ROBOT | {"mass_kg": odd}),
    "Vehicle's wheels": lambda odd: laconic.Vehicle(ROBOT | {"wheel": odd}),
    "Vehicle's wheel": lambda odd: laconic.Vehicle(ROBOT | {"wheel": [odd]}),
    "Vehicle's kind": lambda odd: laconic.Vehicle(ROBOT | {"wheel": [WHEEL | {"kind": odd}]}),
    "Vehicle's lock": lambda odd: laconic.Vehicle(ROBOT | {"wheel": [WHEEL | {"locked": odd}]}),
    "Vehicle's payload": lambda odd: laconic.Vehicle(ROBOT | {"payload": odd}),
    "plant's method": lambda odd: robot().plant(odd), "plant's step": lambda odd: robot().plant(step_s=odd),
    "plant's nu": lambda odd: robot().plant(nu_rad_per_s=odd), "plant's x": lambda odd: robot().plant(x_m=odd),
    "plant's speeds": lambda odd: robot().plant(wheel_speed_rad_per_s=odd),
    "derivative's nu": lambda odd: robot().derivative(odd), "derivative's inputs": lambda odd: robot().derivative(
        inputs=odd), "linearise's heading": lambda odd: robot().linearise(heading_rad=odd),
    "run": lambda odd: plant().run(odd), "run's volts": lambda odd: plant().run({"voltage_V": odd}),
    "run's steps": lambda odd: plant().run(None, odd),
    "run_sampled": lambda odd: plant().run_sampled(odd), "set_step": lambda odd: plant().set_step(odd),
    "change": lambda odd: plant().change(odd), "restore": lambda odd: plant().restore(odd, 1),
    "restore's steps": lambda odd: plant().restore(plant().save(), odd),
    "outputs": lambda odd: plant().outputs(odd), "sensors": lambda odd: plant().sensors(odd),
    "sensors' imu": lambda odd: plant().sensors({"imu": odd}),
    "sensors' seed": lambda odd: plant().sensors({"imu": {"seed": odd}}),
    "sensors' counts": lambda odd: plant().sensors({"encoder": {"counts_per_turn": odd}}),
    "sensors' wrap": lambda odd: plant().sensors({"encoder": {"counts_per_turn": 4, "wrap": odd}}),
    "sensors' gears": lambda odd: plant().sensors({"encoder": {"counts_per_turn": 4, "gear_ratio": odd}}),
    "sensors' restore": lambda odd: plant().sensors().restore(odd),
    "estimate": lambda odd: plant().estimate(odd), "estimate's restore": lambda odd: plant().estimate().restore(odd),
    "tangent's state": lambda odd: plant().step_derivatives().tangent(odd),
    "tangent's vehicle": lambda odd: plant().step_derivatives().tangent(vehicle=odd),
    "adjoint": lambda odd: plant().step_derivatives().adjoint(odd),
    "vehicle_gradient": lambda odd: plant().step_derivatives().vehicle_gradient([1.0] * 9, odd),
    "Filter": lambda odd: laconic.Filter(odd, {}), "Filter's settings": lambda odd: laconic.Filter(plant(), odd),
    "Filter's std": lambda odd: laconic.Filter(plant(), {"nu_std_rad_per_s": odd}),
    "Filter's encoder": lambda odd: laconic.Filter(plant(), {}, encoder=odd),
    "Filter's count": lambda odd: laconic.Filter(plant(), {}, encoder={"counts_per_turn": 4}, start_count=odd),
    "Filter.restore": lambda odd: kept().restore(odd), "encoders": lambda odd: kept().encoders(odd),
    "yaw_rate": lambda odd: kept().yaw_rate(odd), "fix": lambda odd: kept().fix(odd, std_m=1.0),
    "predict's steps": lambda odd: kept().predict(None, odd if not isinstance(odd, int) or odd < 10 else -odd),
    "Batch": laconic.Batch, "Batch's lanes": lambda odd: laconic.Batch(robot(), odd),
    "Batch's kinds": lambda odd: laconic.Batch(robot(), kind_of=odd),
    "Batch's method": lambda odd: laconic.Batch(robot(), 2, odd),
    "Batch's step": lambda odd: laconic.Batch(robot(), 2, step_s=odd),
    "Batch's width": lambda odd: laconic.Batch(robot(), 2, width_bytes=odd),
    "Batch's volts": lambda odd: setattr(batch(), "voltage_V", odd), "Batch.run": lambda odd: batch().run(odd),
    "Batch's threads": lambda odd: batch().run(1, odd), "Batch's start": lambda odd: batch().start(odd),
    "Batch's samples": lambda odd: batch().run_sampled(odd), "Batch's refusal": lambda odd: batch().refusal(odd),
    "ArticulatedBatch": laconic.ArticulatedBatch,
    "ArticulatedBatch's lanes": lambda odd: laconic.ArticulatedBatch(hinged(), odd),
    "ArticulatedBatch's kinds": lambda odd: laconic.ArticulatedBatch(hinged(), kind_of=odd),
    "ArticulatedBatch's method": lambda odd: laconic.ArticulatedBatch(hinged(), 2, odd),
    "ArticulatedBatch's step": lambda odd: laconic.ArticulatedBatch(hinged(), 2, step_s=odd),
    "ArticulatedBatch.of": lambda odd: hinged_batch().of(odd),
    "ArticulatedBatch.set": lambda odd: hinged_batch().set("voltage_V", odd),
    "ArticulatedBatch.run": lambda odd: hinged_batch().run(odd),
    "ArticulatedBatch's threads": lambda odd: hinged_batch().run(1, odd),
    "ArticulatedBatch's refusal": lambda odd: hinged_batch().refusal(odd),
    "ArticulatedBatch.load": lambda odd: hinged_batch().load(0, odd),
    "Batch.load": lambda odd: batch().load(0, odd), "Batch.change": lambda odd: batch().change(0, odd),
    "make_fmu": lambda odd: laconic.make_fmu(odd, "x.fmu", version=2), "make_fmu's version": lambda odd:
        laconic.make_fmu(scene("s1"), "/dev/null/x.fmu", version=odd),
    "make_fmu's file": lambda odd: laconic.make_fmu(scene("s1"), odd, version=odd),
    "plot": laconic.plot, "analyse": laconic.analyse,
    "analyse's parts": lambda odd: laconic.analyse(scene("paper_caster"), parts=odd),
    "analyse's time": lambda odd: laconic.analyse(scene("paper_caster"), parts=["geometry"], at_s=odd),
}


@pytest.mark.parametrize("place", SHORT)
def test_an_odd_value_is_refused_in_one_short_line_or_taken(place: str) -> None:
    assert {name: wrong for name, odd in ODD.items() if (wrong := complaint(SHORT[place], odd()))} == {}


def complaint(function: Callable[[Any], Any], odd: Any) -> str:
    """What is wrong with the answer to an odd value; empty where nothing is."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            function(odd)
        except LaconicError as refused:
            line = str(refused)
            is_short_line = "\n" not in line and len(line) <= LONGEST
            return "" if is_short_line and not any(word in line for word in ("Error", "Exception", " at 0x")) else line
        except Exception as fault:  # a warning, too
            return f"{type(fault).__name__}: {fault}"
    return ""
