"""What a method keeps: energy and K of free motion over a million steps, and the A-norm of random vehicles."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from laconic.core import Core, load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene import METHODS, Scene

STEP_S, STEPS, CHECKS = 0.1, 1_000_000, 60
NORM_STEPS_S = (1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0, 1e3)


def free(scene: Scene) -> Scene:
    """The scene without motors and inputs."""
    vehicle = {k: v for k, v in scene.vehicle.items() if k != "motor"}
    vehicle |= {"motor_gain_Nm_per_V": 0.0, "motor_damping_Nms": 0.0}
    vehicle["wheel"] = [{k: v for k, v in wheel.items() if not k.startswith("motor_")} for wheel in vehicle["wheel"]]
    return replace(scene, vehicle=vehicle, inputs=())


def invariants(plant: Plant) -> np.ndarray:
    """Energy and K in double, from the state with its compensation (ν reads out in the scalar type)."""
    model, state = plant.c.model, plant.c.state
    zeta = np.array([float(part.value) + float(part.rest) for part in state.zeta])
    basis = plant.core.numbers(model.nu_of_zeta, 3, 3).astype(float)
    return np.array([zeta @ zeta, np.linalg.solve(basis.T, zeta)[2]])  # Aν = G⁻ᵀζ


def drift_rows(scene: Scene, reals: tuple[str, ...], methods: tuple[str, ...] = METHODS[1:], steps: int = STEPS,
               advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Largest relative change of energy and K up to some numbers of steps."""
    still = free(scene).with_run(step_s=STEP_S, duration_s=STEP_S * steps)
    checks = np.unique(np.rint(np.logspace(0, np.log10(steps), CHECKS)).astype(int))
    rows = []
    for real in reals:
        for method in methods:
            rows += _drift_of(still.with_run(method=method), real, checks)
            advance()
    return rows


def _drift_of(scene: Scene, real: str, checks: np.ndarray) -> list[dict[str, Any]]:
    core = load(real)
    row = {"real": real, "method": scene.run.method}
    try:
        plant = scene.plant(core)
        begin, worst, rows, done, held = invariants(plant), np.zeros(2), [], 0, core.input()
        for check in checks:
            plant.run(held, int(check) - done)
            done = int(check)
            worst = np.maximum(worst, np.abs(invariants(plant) / begin - 1.0))
            rows.append(row | {"steps": done, "status": "ok", "energy": float(worst[0]), "K": float(worst[1])})
        return rows
    except Refused as refused:
        return [row | {"steps": 0, "status": refused.status}]


def random_vehicle(random: np.random.Generator) -> dict[str, Any]:
    """Any wheels anywhere, any inertias, over several decades; sometimes no damping, sometimes fixed wheels."""
    radius, mass = 10.0 ** random.uniform(-2, 0), 10.0 ** random.uniform(-1, 3)
    wheels = []
    for _ in range(random.integers(0, 7)):
        wheels.append({"kind": "roller", "x_m": radius * 10 * random.normal(), "y_m": radius * 10 * random.normal(),
                       "axle_rad": random.uniform(-np.pi, np.pi), "roller_rad": random.uniform(0.2, np.pi - 0.2)})
    damping = 0.0 if random.random() < 0.3 else mass * radius**2 * 10.0 ** random.uniform(-3, 5)
    return {"mass_kg": mass, "yaw_inertia_kgm2": mass * radius**2 * 10.0 ** random.uniform(-1, 2),
            "com_x_m": radius * random.normal(), "com_y_m": radius * random.normal(), "wheel_radius_m": radius,
            "wheel_inertia_kgm2": mass * radius**2 * 10.0 ** random.uniform(-4, 1), "motor_gain_Nm_per_V": 0.0,
            "motor_damping_Nms": damping, "wheel": wheels}


def norm_rows(reals: tuple[str, ...], methods: tuple[str, ...] = METHODS, vehicles: int = 10_000, seed: int = 20110704,
              advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Growth of the A-norm in one step with U = 0, in ulp, over random vehicles, states and steps."""
    rows = []
    for real in reals:
        random = np.random.default_rng(seed)
        core, found = load(real), {m: _NormCount(real, m) for m in methods}
        for _ in range(vehicles):
            vehicle, nu = random_vehicle(random), random.normal(size=3) * 10.0 ** random.uniform(-2, 3)
            for method, count in found.items():
                count.one(core, vehicle, method, nu, float(random.choice(NORM_STEPS_S)))
            advance()
        rows += [count.row() for count in found.values()]
    return rows


class _NormCount:
    """Growth of the norm over all cases of one method."""

    def __init__(self, real: str, method: str) -> None:
        self.real, self.method, self.taken, self.worst_ulp = real, method, 0, 0.0
        self.refused: dict[str, int] = {}  # number of refusals by their names

    def one(self, core: Core, vehicle: dict[str, Any], method: str, nu: np.ndarray, step_s: float) -> None:
        """One vehicle, one state, one step."""
        try:
            plant = core.plant(core.vehicle(vehicle), method, step_s, nu_rad_per_s=tuple(nu))
            before = _norm(plant)
            plant.run(core.input(), 1)
        except Refused as refused:
            self.refused[refused.status] = self.refused.get(refused.status, 0) + 1
            return
        self.taken += 1
        after = _norm(plant)
        ulp = float(np.spacing(core.dtype.type(before)))
        self.worst_ulp = max(self.worst_ulp, float(after - before) / ulp)

    def row(self) -> dict[str, Any]:
        """For the table."""
        refused = "; ".join(f"{name}: {count}" for name, count in sorted(self.refused.items()))
        return {"real": self.real, "method": self.method, "steps_taken": self.taken, "refused": refused or "none",
                "worst_growth_ulp": self.worst_ulp}


def _norm(plant: Plant) -> np.longdouble:
    """|ζ| = √(νᵀAν), value and rest, in more digits than the core has, so that the sum adds no rounding."""
    zeta = [np.longdouble(part.value) + np.longdouble(part.rest) for part in plant.c.state.zeta]
    return np.sqrt(np.sum(np.square(np.array(zeta))))
