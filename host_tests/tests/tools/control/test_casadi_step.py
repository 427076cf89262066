"""The core's step in CasADi: values and Jacobian, and a path planned by multiple shooting."""

from __future__ import annotations

import casadi
import numpy as np
import pytest

import laconic
from laconic import BadInput, Refused
from laconic.scene.methods import EXPLICIT, STIFF
from laconic.tools.control import casadi_step

CARRIAGE = {"mass_kg": 10.0, "yaw_inertia_kgm2": 0.2, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.002,
            "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02, "payload": {"mass_kg": 1.0, "x_m": 0.05, "y_m": 0.0},
            "wheel": [{"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0},
                      {"kind": "omni", "x_m": -0.1, "y_m": 0.0, "axle_rad": 3.0},
                      {"kind": "omni", "x_m": 0.0, "y_m": 0.12, "axle_rad": 1.5}]}
STATE, VOLTS = np.array([1.0, -0.5, 2.0, 0.3, -0.2, 0.7]), np.array([2.0, -1.0, 0.5])
PARAMETERS = ["mass_kg", "payload.mass_kg", "wheel[2].x_m"]


def plant(step_s=0.05, method="auto", **more):
    return laconic.Vehicle({**CARRIAGE, **more}).plant(method, step_s)


def test_it_is_the_core_s_step_and_its_jacobian():
    step, other = casadi_step(plant()), plant()
    start = laconic.Vehicle(CARRIAGE).plant("auto", 0.05, nu_rad_per_s=STATE[:3], x_m=0.3, y_m=-0.2, heading_rad=0.7)
    jacobian = start.step_derivatives({"voltage_V": VOLTS.tolist()}).jacobian()
    start.run({"voltage_V": VOLTS.tolist()})
    assert np.array_equal(step(STATE, VOLTS).full().ravel(), [*start.nu, *start.pose[:3]])
    by_state, by_voltage = step.jacobian()(STATE, VOLTS, np.zeros(6))
    assert np.array_equal(by_state.full(), jacobian.by_state[:6, :6])
    assert np.array_equal(by_voltage.full(), jacobian.by_input[:6, :3])
    assert other.steps == 0


@pytest.mark.parametrize("method", ["auto", EXPLICIT, STIFF])
def test_its_jacobian_agrees_with_casadi_s_finite_differences(method):
    step = casadi_step(plant(method=method), PARAMETERS)
    arguments = [casadi.MX.sym("s", 6), casadi.MX.sym("u", 3), casadi.MX.sym("p", 3)]
    values = [STATE, VOLTS, np.array([10.0, 1.0, -0.1])]
    own = casadi.Function("own", arguments, [step(*arguments)])
    differences = casadi.Function("differences", arguments, [step(*arguments)],
                                  {"enable_fd": True, "enable_forward": False, "enable_reverse": False,
                                   "enable_jacobian": False, "fd_method": "central", "never_inline": True})
    for k in range(3):
        slopes = [casadi.Function("j", arguments, [casadi.jacobian(f(*arguments), arguments[k])])(*values)
                  for f in (own, differences)]
        found, expected = (each.full() for each in slopes)
        assert not np.array_equal(found, expected)  # they are differences
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-6)


def test_parameters_are_numbers_of_the_vehicle():
    step = casadi_step(plant(), PARAMETERS)
    wheels = [dict(each) for each in CARRIAGE["wheel"]]
    wheels[1]["x_m"] = -0.13
    other = laconic.Vehicle({**CARRIAGE, "mass_kg": 12.0, "payload": {"mass_kg": 2.5, "x_m": 0.05, "y_m": 0.0},
                             "wheel": wheels})
    expected = casadi_step(other.plant("auto", 0.05))(STATE, VOLTS)
    assert step(STATE, VOLTS, [12.0, 2.5, -0.13]).full() == pytest.approx(expected.full(), rel=1e-13)


def test_what_makes_no_sense_is_refused_by_name():
    with pytest.raises(BadInput, match="friction"):
        casadi_step(plant(ground={"friction_coefficient": 0.5}))
    with pytest.raises(BadInput, match="wheel_mass_kg"):
        casadi_step(plant(), ["wheel_mass_kg"])


def test_a_step_that_the_core_refuses_says_so():
    step = casadi_step(plant(method=EXPLICIT))
    fast, text = [0, 0, 1e6, 0, 0, 0], "unstable with this method at this yaw rate"
    with pytest.raises(Refused, match=text):
        step(fast, VOLTS)
    state = casadi.MX.sym("s", 6)
    with pytest.raises(RuntimeError, match=text):  # within an expression it is CasADi that calls
        casadi.Function("twice", [state], [2 * step(state, VOLTS)])(fast)


def plan(step, steps, goal, limit_V, obstacle, room_m):
    """States and voltages of the least effort to a pose at rest, outside a disc, by multiple shooting."""
    opti = casadi.Opti()
    state, volts = opti.variable(6, steps + 1), opti.variable(3, steps)
    opti.minimize(casadi.sumsqr(volts))
    opti.subject_to(state[:, 0] == 0)
    opti.subject_to(state[:, steps] == casadi.vertcat(0, 0, 0, *goal))
    for k in range(steps):
        opti.subject_to(state[:, k + 1] == step(state[:, k], volts[:, k]))
        opti.subject_to((state[3, k] - obstacle[0]) ** 2 + (state[4, k] - obstacle[1]) ** 2 >= room_m**2)
        opti.set_initial(state[3:, k], casadi.DM([goal[0] * k / steps, goal[1] * k / steps + 0.2, 0]))
    opti.subject_to(opti.bounded(-limit_V, casadi.vec(volts), limit_V))
    quiet = {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory", "tol": 1e-6}
    opti.solver("ipopt", {"print_time": False}, quiet)
    found = opti.solve()
    return found.value(state), found.value(volts)


def test_a_path_around_an_obstacle_is_planned_within_the_voltages():
    robot, goal, limit_V = laconic.Vehicle.of(laconic.read_scene("robotino2")), (1.0, 0.0, 1.0), 8.0
    states, volts = plan(casadi_step(robot.plant("auto", 0.2)), 16, goal, limit_V, (0.5, 0.0), 0.3)
    driven = robot.plant("auto", 0.2)
    for k in range(16):
        driven.run({"voltage_V": volts[:, k].tolist()})
        assert [*driven.nu, *driven.pose[:3]] == pytest.approx(states[:, k + 1], abs=1e-5)
    assert driven.pose[:3] == pytest.approx(goal, abs=1e-5)
    assert np.abs(volts).max() == pytest.approx(limit_V, abs=1e-4)  # it needs all of them
    assert np.hypot(states[3] - 0.5, states[4]).min() == pytest.approx(0.3, abs=1e-4)  # and touches the obstacle
