"""Whole vehicles of the core that nothing drives: their energy never grows, and what rests stays at rest.

Each goes through `laconic_plant`: normal loads, rotation, slope, drives with limits, the friction step, the pose.
Motors get no voltage, so they only brake: driven (within their current limit), open or shorted. Energy is the kinetic
one and that in the slope. What rests is held by brakes (dry friction of the axles, more than the contacts bear) against
a pull of less than the drag of all rollers, in any direction, and too low to topple; statics then has a solution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.core import load
from laconic.core.plant import Plant
from laconic.errors import Refused
from references.friction.vehicles import GRAVITY, random_vehicle

STEPS = 500                             # of one vehicle
ROUNDING = {"double": 1e-11, "single": 1e-4}   # of the largest energy so far: the residual that a step may have
SHARE = 0.9                             # of breakaway


@dataclass
class Coasted:
    """What was found in many steps; `wrong` has one line each."""

    steps: int = 0
    resting: int = 0            # steps of vehicles that rest
    stopped: int = 0            # vehicles that came to exact rest
    vehicles: int = 0
    refused: int = 0
    growth: float = -math.inf   # the worst of all, of the largest energy
    wrong: list[str] = field(default_factory=list)

    def text(self) -> str:
        """For a report."""
        if self.resting:
            return f"{self.resting} steps of {self.vehicles} vehicles"
        return (f"{self.steps} steps of {self.vehicles} vehicles, {self.stopped} came to exact rest, {self.refused} "
                f"steps refused, worst growth {self.growth:.1e} of the energy")


@dataclass
class Slope:
    """Where a plant stands on its slope."""

    weight_N: float     # along it
    heading_rad: float

    def potential_J(self, plant: Plant) -> float:
        """0 where the run began."""
        state = plant.c.state
        return self.weight_N * (state.x_m.value * math.cos(self.heading_rad)
                                + state.y_m.value * math.sin(self.heading_rad))

    def energy_of_a_step_J(self, plant: Plant) -> float:
        """That of the free motion of a step from rest: what the solver's accuracy counts by."""
        impulse_Ns = plant.step_s * self.weight_N
        return 0.5 * impulse_Ns**2 / float(plant.c.model.mass_kg)


def coast(seed: list[int], count: Coasted, real: str = "double", steps: int = STEPS) -> None:
    """One random vehicle that is thrown, and then left alone."""
    random = np.random.default_rng(seed)
    vehicle = _coasting_vehicle(random)
    pace = 10.0 ** random.uniform(-2, 2)
    wheels = len(vehicle["wheel"])
    plant, slope = _started(real, vehicle, 10.0 ** random.uniform(-4, -1.5), pace * random.standard_normal(3),
                            pace * random.standard_normal(wheels), random.uniform(-math.pi, math.pi))
    held = plant.core.input()
    count.vehicles += 1
    kinetic, potential = plant.energy_J(), 0.0
    energy, largest = kinetic, max(kinetic, slope.energy_of_a_step_J(plant))
    for step in range(steps):
        try:
            plant.run(held)
        except Refused as refused:
            count.refused += refused.status == "step unsolved"
            if refused.status != "step unsolved":
                count.wrong.append(f"{real} {seed} step {step}: {refused}")
            return
        kinetic, potential = plant.energy_J(), slope.potential_J(plant)
        now, largest = kinetic + potential, max(largest, kinetic, abs(potential))
        growth = (now - energy) / largest if largest > 0.0 else now - energy
        count.growth = max(count.growth, growth)
        if not growth <= ROUNDING[real]:        # NaN too
            count.wrong.append(f"{real} {seed} step {step}: energy grows by {growth:.1e}")
            return
        energy = now
        count.steps += 1
    count.stopped += kinetic == 0.0


def rest(seed: list[int], count: Coasted, real: str = "double", steps: int = STEPS) -> None:
    """One random vehicle with its brakes on, pulled by less than breakaway: no bit of its state changes."""
    random = np.random.default_rng(seed)
    vehicle, pull_N = _braked_vehicle(random)
    plant, _ = _started(real, vehicle, 10.0 ** random.uniform(-4, -1.5), np.zeros(3), np.zeros(len(vehicle["wheel"])),
                        random.uniform(-math.pi, math.pi))
    count.vehicles += 1
    before = _bits(plant)
    for _ in range(2):          # the pull changes once
        angle, size = random.uniform(-math.pi, math.pi), pull_N * random.random()
        held = plant.core.input({"world_force_N": [size * math.cos(angle), size * math.sin(angle)]})
        plant.run(held, steps // 2)
        count.resting += steps // 2
        if _bits(plant) != before:
            count.wrong.append(f"{real} {seed}: what rests has moved")
            return


def _bits(plant: Plant) -> bytes:
    state, slip = plant.c.state, plant.c.slip
    numbers = [*(each.value for each in state.zeta), state.x_m.value, state.y_m.value,
               *slip.wheel_speed_rad_per_s, *(each.value for each in slip.wheel_angle_rad)]
    heading = plant.core.ffi.buffer(plant.core.ffi.addressof(state, "heading"))
    return np.array([abs(each) for each in numbers]).tobytes() + bytes(heading)


def _started(real: str, vehicle: dict[str, Any], step_s: float, nu: np.ndarray, speeds: np.ndarray,
             heading_rad: float) -> tuple[Plant, Slope]:
    core = load(real)
    ground = vehicle["ground"]
    plant = core.plant(core.vehicle(vehicle), "auto", step_s, nu_rad_per_s=nu.tolist(), heading_rad=heading_rad,
                       wheel_speed_rad_per_s=speeds.tolist())
    angle = float(plant.c.vehicle.ground.slope_rad)
    return plant, Slope(float(plant.c.model.mass_kg) * GRAVITY * math.sin(angle), ground["slope_heading_rad"])


def _coasting_vehicle(random: np.random.Generator) -> dict[str, Any]:
    vehicle = random_vehicle(random)
    ground = vehicle["ground"]
    ground["slope_rad"] = float(random.choice([0.0, random.uniform(0, 0.6)]))
    ground["slope_heading_rad"] = random.uniform(-math.pi, math.pi)
    vehicle["com_z_m"] = float(random.choice([0.0, random.uniform(0, 2) * vehicle["wheel_radius_m"]]))
    for wheel in vehicle["wheel"]:
        wheel["motor_circuit"] = int(random.choice([0, 0, 1, 2]))
        _differ(random, vehicle, wheel)
    if random.random() < 0.3:
        vehicle["wheel"][0]["driven"] = False
    return vehicle


def _differ(random: np.random.Generator, vehicle: dict[str, Any], wheel: dict[str, Any]) -> None:
    """Now and then a wheel of its own."""
    own = {"radius_m": vehicle["wheel_radius_m"], "inertia_kgm2": vehicle["wheel_inertia_kgm2"],
           "friction_coefficient": vehicle["ground"]["friction_coefficient"],
           "axle_friction_Nm": vehicle["ground"]["axle_friction_Nm"]}
    for key, value in own.items():
        if value > 0.0 and random.random() < 0.1:
            wheel[key] = value * 10.0 ** random.uniform(-0.5, 0.5)


def _braked_vehicle(random: np.random.Generator) -> tuple[dict[str, Any], float]:
    """A ring of wheels around the centre of mass, and the pull that it bears for certain beside its slope [N]."""
    count = int(random.integers(3, 7))
    vehicle = random_vehicle(random, count)
    vehicle.pop("drive", None)
    reach = 3.0 * vehicle["wheel_radius_m"]
    for i, wheel in enumerate(vehicle["wheel"]):
        around = 2.0 * math.pi * i / count
        wheel |= {"x_m": reach * math.cos(around), "y_m": reach * math.sin(around)}
    ground, weight_N = vehicle["ground"], vehicle["mass_kg"] * GRAVITY
    ground["roller_drag"] = random.uniform(0.05, 1.0)
    share = SHARE * ground["friction_coefficient"] * ground["roller_drag"]     # of the weight across the slope
    vehicle["com_z_m"] = 0.4 * reach * float(random.choice([0.0, min(1.0, 1.0 / share)]))
    slope_rad = float(random.choice([0.0, random.random()])) * 0.5 * min(math.atan(share), 0.5)
    ground |= {"slope_rad": slope_rad, "slope_heading_rad": random.uniform(-math.pi, math.pi)}
    ground["axle_friction_Nm"] = 2.0 * ground["friction_coefficient"] * weight_N * vehicle["wheel_radius_m"]
    return vehicle, weight_N * (share * math.cos(slope_rad) - math.sin(slope_rad))
