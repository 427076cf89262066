"""What the ground has to give: normal loads at rest, and grip for an acceleration, for many vehicles at once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from laconic.measures.prepared import Group
from laconic.measures.stability import straight_zeta


def _contacts(group: Group) -> Iterator[Any]:
    """The laconic_contact of each vehicle in turn; the same memory."""
    core = group.core
    contact, why = core.ffi.new("laconic_contact *"), core.why()
    for vehicle, _ in group.pointers:
        core.check(core.lib.laconic_contact_prepare(contact, vehicle, why), why)
        yield contact


def least_load_share(group: Group) -> np.ndarray:
    """The least normal load of a wheel or support at rest over the weight; below 0 the vehicle tips."""
    found = []
    for contact, (_, model) in zip(_contacts(group), group.pointers, strict=True):
        loads = group.core.numbers(contact.normal_load_of_wrench, -1, 3)[: contact.point_count, 0]
        found.append(float(loads.min(initial=np.inf)) * float(model.wheel_radius_m))
    return np.array(found)


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
    margins = np.array([_margin_N(group, contact, model, row) for contact, (_, model), row in
                        zip(_contacts(group), group.pointers, torques, strict=True)])
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
