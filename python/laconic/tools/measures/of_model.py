"""The measures of a model: what is known of a vehicle without a run. Name with unit, arguments, one line of text."""

from __future__ import annotations

import numpy as np

from laconic.tools.measures import authority, stability
from laconic.tools.measures.arguments import REQUIRED, ArguedMeasure
from laconic.tools.measures.prepared import Group


def _farthest_wheel_m(group: Group) -> np.ndarray:
    return np.linalg.norm(group.positions_m, axis=2).max(axis=1, initial=0.0)


def _mass_kg(group: Group) -> np.ndarray:
    return group.models["mass_kg"]


DIRECTION = {"direction_deg": REQUIRED}

MEASURES_OF_MODELS = (
    ArguedMeasure("condition", "Rim speed that the hardest motion of the body needs over that of the easiest; yaw "
                  "counts as its rate times length_m, or times the wheels' distance from their middle (root mean "
                  "square)", authority.condition, arguments={"length_m": None}),
    ArguedMeasure("yaw_authority", "Least rim speed that yaws the body, over the yaw rate times the wheels' distance "
                  "from their middle; about 1 is usual", authority.yaw_authority),
    ArguedMeasure("yaw_moment_Nm_per_V", "Largest moment of the motors about the centre of mass, every voltage "
                  "within ±1 V", authority.yaw_moment_per_V),
    ArguedMeasure("yaw_acceleration_rad_per_s2_per_V", "Largest yaw acceleration from rest, every voltage "
                  "within ±1 V", authority.yaw_acceleration_per_V),
    ArguedMeasure("yaw_rate_rad_per_s_per_V", "Largest steady yaw rate of small voltages, for each volt that "
                  "none exceeds", authority.yaw_rate_per_V),
    ArguedMeasure("worst_acceleration_m_per_s2_per_V", "Acceleration from rest that every direction of travel "
                  "allows, without yaw, every voltage within ±1 V", authority.worst_acceleration_per_V),
    ArguedMeasure("worst_speed_m_per_s_per_V", "Steady speed that every direction of travel allows, without yaw, "
                  "every voltage within ±1 V", authority.worst_speed_per_V),
    ArguedMeasure("slowest_damping_per_s", "The smallest damping rate; 0 where a motion coasts for ever",
                  stability.slowest_damping_per_s),
    ArguedMeasure("fastest_damping_per_s", "The largest damping rate; a step much longer than its inverse needs a "
                  "stiff method", stability.fastest_damping_per_s),
    ArguedMeasure("straight_stable_speed_m_per_s", "Up to which speed straight motion in a direction of the body "
                  "(0° along x) is stable; infinite where at every speed", stability.straight_stable_speed_m_per_s,
                  arguments=DIRECTION),
    ArguedMeasure("straight_growth_per_s", "Rate at which a disturbance of straight motion grows: the largest real "
                  "part of its eigenvalues, below 0 it decays", stability.straight_growth_per_s,
                  arguments={"speed_m_per_s": REQUIRED} | DIRECTION),
    ArguedMeasure("steady_growth_per_s", "The same of the steady motion, straight or turning, that is most stable "
                  "under the inputs of the run's start", stability.steady_growth_per_s),
    ArguedMeasure("least_load_share", "Least normal load of a wheel or support at rest over the weight; below 0 the "
                  "vehicle tips", authority.least_load_share),
    ArguedMeasure("grip_margin_N", "Least of friction coefficient times normal load less reaction, as it starts from "
                  "rest straight in a direction; below 0 a wheel slips", authority.grip_margin_N,
                  arguments={"acceleration_m_per_s2": REQUIRED} | DIRECTION, needs="friction coefficient"),
    ArguedMeasure("total_mass_kg", "Mass with payload", _mass_kg),
    ArguedMeasure("total_yaw_inertia_kgm2", "Moment of inertia about the vertical through the centre of mass, "
                  "with payload", authority.yaw_inertia_kgm2),
    ArguedMeasure("farthest_wheel_m", "Distance of the farthest wheel from the body's origin", _farthest_wheel_m))
