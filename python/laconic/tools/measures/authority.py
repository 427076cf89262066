"""What the wheels can do with the body, for many vehicles at once: condition, yaw, and the worst direction of travel.

All of it is linear: at rest a vehicle's acceleration is a fixed matrix times the voltages, and so is the steady motion
of small voltages, in which gyroscopic forces, quadratic in the speed, do not yet act.

What the ground has to give: normal loads at rest, and grip for an acceleration, for many vehicles at once.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from laconic.batch.population import contacts_of, items_of
from laconic.tools.measures.prepared import Group
from laconic.tools.measures.stability import straight_zeta

RANK_TOLERANCE = 1e-9


# ---- kinematics: Ξ in metres per second, rim speeds R_i χ_i' against the body's (v_ξ, v_η, ℓ θ')

def spread_m(positions_m: np.ndarray) -> np.ndarray:
    """ℓ of wheels at (…, N, 2): their root mean square distance from their middle; 1 m where they have no extent."""
    if positions_m.shape[-2] == 0:
        return np.ones(positions_m.shape[:-2])
    middle = positions_m.mean(axis=-2, keepdims=True)
    distance = np.sqrt(((positions_m - middle) ** 2).sum(axis=-1).mean(axis=-1))
    return np.where(distance > 0.0, distance, 1.0)


def condition_of(rows: np.ndarray) -> np.ndarray:
    """Largest over smallest singular value of rows (…, N, m); infinite where the rank is below m."""
    if rows.shape[-2] < rows.shape[-1]:
        return np.full(rows.shape[:-2], np.inf)
    values = np.linalg.svd(rows, compute_uv=False)
    short = values[..., -1] <= RANK_TOLERANCE * values[..., 0]
    return np.where(short, np.inf, values[..., 0] / np.where(short, 1.0, values[..., -1]))


def yaw_authority_of(rows: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """Least root mean square rim speed of an allowed motion with ℓ θ' = 1; 0 where nothing can yaw.

    rows (…, N, m) of the motions with the orthonormal columns `allowed` (…, 3, m) of (v_ξ, v_η, ℓ θ').
    """
    if rows.shape[-2] == 0:
        return np.zeros(rows.shape[:-2])
    _, values, right = np.linalg.svd(_padded(rows))
    pull = (right @ allowed[..., 2, :, None])[..., 0]
    size = np.abs(pull).max(axis=-1)
    lacks = values <= RANK_TOLERANCE * np.maximum(values[..., :1], 1e-300)
    coasts = (lacks & (np.abs(pull) > RANK_TOLERANCE * size[..., None])).any(axis=-1) | (size < 1e-12)
    square = np.where(lacks, 0.0, pull / np.where(lacks, 1.0, values)) ** 2
    total = square.sum(axis=-1)
    return np.where(coasts, 0.0, 1.0 / np.sqrt(np.where(coasts, 1.0, total) * rows.shape[-2]))


def _padded(rows: np.ndarray) -> np.ndarray:
    """With rows of zeros, as many rows as columns at least: every direction gets its singular value."""
    missing = rows.shape[-1] - rows.shape[-2]
    shape = (*rows.shape[:-2], max(missing, 0), rows.shape[-1])
    return np.concatenate([rows, np.zeros(shape)], axis=-2) if missing > 0 else rows


def _rim_rows(group: Group, length_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rim speeds of the allowed motions, and these motions as orthonormal columns of (v_ξ, v_η, ℓ θ')."""
    columns = group.motion_of_zeta.copy()
    columns[:, 2] *= length_m[:, None]
    allowed, triangle = np.linalg.qr(columns)
    rims = group.radii_m[:, :, None] * group.wheel_of_zeta
    return np.swapaxes(np.linalg.solve(np.swapaxes(triangle, 1, 2), np.swapaxes(rims, 1, 2)), 1, 2), allowed


def condition(group: Group, length_m: float | None = None) -> np.ndarray:
    """Rim speed that the hardest motion needs over that of the easiest; `length_m`: ℓ, that of `spread_m` if None."""
    length = spread_m(group.positions_m) if length_m is None else np.full(len(group.models), float(length_m))
    return condition_of(_rim_rows(group, length)[0])


def yaw_authority(group: Group) -> np.ndarray:
    """As `laconic analyse --only geometry`."""
    return yaw_authority_of(*_rim_rows(group, spread_m(group.positions_m)))


# ---- what a volt does

def acceleration_of_voltage(group: Group) -> np.ndarray:
    """(m/s², m/s², rad/s²) at rest per volt of each wheel, (L, 3, N)."""
    return group.motion_of_zeta @ group.zeta_rate_of_voltage


def speed_of_voltage(group: Group) -> np.ndarray:
    """Steady (m/s, m/s, rad/s) per small volt of each wheel, (L, 3, N); infinite for driven motion without damping."""
    drive, decay = group.zeta_rate_of_voltage, group.decay_per_s[:, :, None]
    damped = decay > 1e-12 * decay.max(axis=1, keepdims=True, initial=0.0)
    steady = np.where(damped, drive / np.where(damped, decay, 1.0), 0.0)
    found = group.motion_of_zeta @ steady
    runs_away = (np.abs(group.motion_of_zeta) @ np.where(damped, 0.0, np.abs(drive))) > 0.0
    return np.where(runs_away, np.inf, found)


def yaw_moment_per_V(group: Group) -> np.ndarray:
    """Largest moment about the centre of mass, wheels' inertia apart, with every voltage within ±1 V [N·m]."""
    return np.abs(lever_over_radius(group) * group.of_wheels("motor_gain_Nm_per_V")).sum(axis=1)


def lever_over_radius(group: Group) -> np.ndarray:
    """Moment about the centre of mass per N·m on each axle, (L, N): the ground's force acts along the roller's axis u
    with 1/(R sin γ) a N·m, at the wheel's lever arm about the centre of mass."""
    wheels = group.vehicles["wheel"][:, : group.wheels]
    fixed = wheels["kind"] == group.core.lib.LACONIC_WHEEL_FIXED
    roller = np.where(fixed, 0.5 * np.pi, wheels["roller_rad"])
    across = wheels["axle_rad"] + roller
    com_m = np.stack([group.models["com_x_m"], group.models["com_y_m"]], axis=-1)
    arm = group.positions_m - com_m[:, None, :]
    lever = arm[..., 0] * np.sin(across) - arm[..., 1] * np.cos(across)
    return lever / (group.radii_m * np.sin(roller))


def yaw_inertia_kgm2(group: Group) -> np.ndarray:
    """I_S = Λ² M R², payload included."""
    models = group.models
    return models["yaw_scale"] ** 2 * models["mass_kg"] * models["wheel_radius_m"] ** 2


def yaw_acceleration_per_V(group: Group) -> np.ndarray:
    """Largest yaw acceleration from rest with every voltage within ±1 V [rad/s²]."""
    return np.abs(acceleration_of_voltage(group)[:, 2]).sum(axis=1)


def yaw_rate_per_V(group: Group) -> np.ndarray:
    """Largest steady yaw rate of small voltages, for each volt that none exceeds [rad/s]."""
    return np.abs(speed_of_voltage(group)[:, 2]).sum(axis=1)


def worst_acceleration_per_V(group: Group) -> np.ndarray:
    """Acceleration that every direction of travel allows from rest, without yaw, with every voltage within ±1 V [m/s²].
    """
    return straight_reach(acceleration_of_voltage(group))


def worst_speed_per_V(group: Group) -> np.ndarray:
    """Steady speed that every direction of travel allows, without yaw, with every voltage within ±1 V [m/s]."""
    return straight_reach(speed_of_voltage(group))


def straight_reach(columns: np.ndarray) -> np.ndarray:
    """Radius of the largest disc of (x, y) that columns (L, 3, N), each times −1 … 1, reach with a third entry of 0.

    What they reach in space is a zonotope; each facet has two columns in it. A facet with normal n at the height
    h = Σ |n · column| cuts the plane of no yaw in an edge at the distance h/|n_xy|; the nearest edge is the radius.
    Where no column yaws, the axis of yaw takes the place of one of the two.
    """
    finite = np.isfinite(columns).all(axis=(1, 2))
    work = np.where(np.isfinite(columns), columns, 0.0)
    size = np.linalg.norm(work[:, :2], axis=1).max(axis=1, initial=0.0)
    yaw = np.abs(work[:, 2]).max(axis=1, initial=0.0)
    turns = yaw > 1e-12 * size
    work[:, 2] *= np.where(turns, size / np.where(turns, yaw, 1.0), 0.0)[:, None]  # yaw is 0 there: its scale is free
    axis = np.where(turns, 0.0, size)[:, None] * np.array([0.0, 0.0, 1.0])
    work = np.concatenate([work, axis[:, :, None]], axis=2)
    radius = np.full(len(work), np.inf)
    for i, j in combinations(range(work.shape[2]), 2):
        normal = np.cross(work[:, :, i], work[:, :, j])
        along = np.linalg.norm(normal[:, :2], axis=1)
        height = np.abs(np.einsum("lk,lkn->ln", normal, work)).sum(axis=1)
        is_edge = along > 1e-12 * size**2
        radius = np.where(is_edge, np.minimum(radius, height / np.where(is_edge, along, 1.0)), radius)
    return np.where(_is_solid(work), radius, np.where(finite, 0.0, np.inf))


def _is_solid(columns: np.ndarray) -> np.ndarray:
    """Whether the columns span space."""
    if columns.shape[2] < 3:
        return np.zeros(len(columns), bool)
    values = np.linalg.svd(columns, compute_uv=False)
    return values[:, 2] > RANK_TOLERANCE * np.maximum(values[:, 0], 1e-300)


def least_load_share(group: Group) -> np.ndarray:
    """The least normal load of a wheel or support at rest over the weight; below 0 the vehicle tips."""
    contacts, _ = contacts_of(group.core, group.vehicles.copy())
    loads = contacts["normal_load_of_wrench"][:, :, 0]
    stands = np.arange(loads.shape[1]) < contacts["point_count"][:, None]
    return np.where(stands, loads, np.inf).min(axis=1) * group.models["wheel_radius_m"]


def grip_margin_N(group: Group, acceleration_m_per_s2: float, direction_deg: float) -> np.ndarray:
    """Least of friction coefficient times load less reaction over the wheels, as the vehicle starts from rest straight
    in a direction of the body; the axle torques are the smallest that do it. NaN where no torques do."""
    wanted = acceleration_m_per_s2 * straight_zeta(group, np.radians(direction_deg))
    usable = np.asarray(np.isfinite(wanted).all(axis=1))
    wanted = np.where(usable[:, None], wanted, 0.0)
    drive = group.zeta_rate_of_torque
    torques = (np.linalg.pinv(drive) @ wanted[:, :, None])[..., 0]
    size = np.abs(wanted).max(axis=1)
    missed = np.abs((drive @ torques[:, :, None])[..., 0] - wanted).max(axis=1)
    contacts, _ = contacts_of(group.core, group.vehicles.copy())
    first = items_of(group.core, "laconic_contact", contacts)
    margins = np.array([_margin_N(group, first + lane, model, row) for lane, ((_, model), row) in
                        enumerate(zip(group.pointers, torques, strict=True))])
    return np.where(usable & (missed <= 1e-9 * size), margins, np.nan)


def _margin_N(group: Group, contact: Any, model: Any, torques_Nm: np.ndarray) -> float:
    """The core's no-slip margin at rest with these torques on the axles."""
    core = group.core
    held = core.input({"axle_torque_Nm": torques_Nm.tolist()}, group.wheels)
    state, why = core.ffi.new("laconic_state *"), core.why()
    core.check(core.lib.laconic_state_set(state, model, core.ffi.new("laconic_start *"), why), why)
    found = core.ffi.new("laconic_reactions *")
    core.lib.laconic_reactions_of(found, contact, model, state, held)
    return float(found.no_slip_margin_N)
