"""What the ground has to give: normal loads at rest, and grip for an acceleration, for many vehicles at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.batch.population import contacts_of, items_of
from laconic.tools.measures.prepared import Group
from laconic.tools.measures.stability import straight_zeta


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
