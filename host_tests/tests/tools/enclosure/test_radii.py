"""What the radii promise: whatever starts inside stays inside, bounds are bounds, and closed solutions are held."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from laconic.base.paths import scene_path
from laconic.tools.enclosure.balls import ball, precision, times, widened
from laconic.tools.enclosure.defect import growth_rate, is_positive
from laconic.tools.enclosure.equation import Equation, equation_of
from laconic.tools.enclosure.loads import Stretch
from laconic.tools.enclosure.motion import Motion
from laconic.tools.enclosure.readings import entries_as_written
from laconic.tools.enclosure.state import Beginning, Sample

END = Fraction(3, 2)
PUSH = {"world_force_N[1]": Fraction(3), "world_force_N[2]": Fraction(-2), "world_force_point_m[1]": Fraction(1, 10)}


def scene_equation(name: str) -> Equation:
    return equation_of(entries_as_written(scene_path(name))["vehicle"])


def end_of(equation: Equation, nu: list, values: dict, radius: float = 0.0) -> Sample:
    """The state after 1.5 s from a ball of starts."""
    zeta = [widened(x, arb(radius)) for x in times(equation.zeta_of_nu, nu)]
    motion = Motion(equation, Beginning(zeta, [arb(0), arb(0)], arb(0)), 80)
    return next(motion.samples([Stretch(Fraction(0), END, values)], [END]))


@pytest.mark.parametrize(("scene", "nu"), [("paper_three_wheel_hopf", (31, 2, 11)), ("s1", (3, -8, 2)),
                                           ("robotino2", (5, 4, -6)), ("paper_three_wheel_free", (0, 6, 1))])
@pytest.mark.parametrize("values", [{}, PUSH, {"body_force_N[1]": Fraction(7), "body_moment_Nm": Fraction(1, 3)}])
def test_every_motion_that_starts_in_a_ball_ends_inside_its_enclosure(scene, nu, values):
    source = random.Random(5)
    with precision(128):
        equation = scene_equation(scene)
        around = end_of(equation, [arb(x) for x in nu], values, radius=1e-6)
        for _ in range(4):
            off = np.array([source.gauss(0, 1) for _ in range(3)])
            off *= 0.999e-6 / np.linalg.norm(off)
            zeta = [x.mid() + arb(float(d)) for x, d in
                    zip(times(equation.zeta_of_nu, [arb(x) for x in nu]), off, strict=True)]
            motion = Motion(equation, Beginning(zeta, [arb(0), arb(0)], arb(0)), 80)
            one = next(motion.samples([Stretch(Fraction(0), END, values)], [END]))
            assert all(wide.contains(narrow) for wide, narrow in zip(around.row(), one.row(), strict=True))
            assert all(float(narrow.rad()) < 1e-18 for narrow in one.row())


def test_errors_of_free_motion_grow_in_proportion_to_time_and_not_exponentially():
    with precision(160):
        equation, found = scene_equation("paper_three_wheel_free"), []
        for seconds in (40, 160):
            zeta = [widened(x, arb(1e-12)) for x in times(equation.zeta_of_nu, [arb(0), arb(6), arb(1)])]
            motion = Motion(equation, Beginning(zeta, [arb(0), arb(0)], arb(0)), 80)
            end = Fraction(seconds)
            found.append(next(motion.samples([Stretch(Fraction(0), end, {})], [end])))
            assert motion.by_direction
    assert max(float(x.rad()) for x in found[0].nu) < 2e-9
    assert max(float(x.rad()) for x in found[1].nu) < 5e-9


def test_instants_within_a_step_and_steps_that_are_cut_there_hold_the_same_motion():
    with precision(160):
        equation = scene_equation("s1")
        instants = [Fraction(k, 7) for k in range(11)]
        values = {"voltage_V[1]": Fraction(2), "voltage_V[3]": Fraction(-1), **PUSH}
        whole, cut = (Motion(equation, Beginning([arb(1), arb(2), arb(3)], [arb(0), arb(0)], arb(1)), 112)
                      for _ in range(2))
        along = list(whole.samples([Stretch(Fraction(0), END, values)], instants))
        at_cuts = list(cut.samples([Stretch(a, b, values) for a, b in zip(instants, instants[1:], strict=False)],
                                   instants))
    assert whole.steps_taken < cut.steps_taken
    for one, other in zip(along, at_cuts, strict=True):
        assert all(a.overlaps(b) and float(a.rad()) < 1e-24 for a, b in zip(one.row(), other.row(), strict=True))


def test_a_push_of_a_puck_is_the_parabola_that_it_must_be():
    puck = {"mass_kg": Fraction(1, 10), "yaw_inertia_kgm2": Fraction(3, 10), "wheel_radius_m": Fraction(1, 10)}
    with precision(160):
        equation = equation_of(puck)
        end = end_of(equation, [arb(0)] * 3, {"body_force_N[1]": Fraction(1, 3)})
        assert end.place_m[0].overlaps(ball(Fraction(1, 2) * Fraction(10, 3) * END**2))
        assert end.place_m[1].contains(0) and end.heading_rad.contains(0)
        assert max(float(x.rad()) for x in end.row()) < 1e-20


def test_the_growth_rate_bounds_the_largest_eigenvalue_and_hardly_exceeds_it():
    source = random.Random(7)
    with precision(128):
        equation = scene_equation("paper_three_wheel_hopf")
        for _ in range(20):
            zeta = [arb(source.gauss(0, 10)) for _ in range(3)]
            z, w, g = (np.array([float(x) for x in v]) for v in (zeta, equation.gyro, equation.spin))
            form = np.outer(np.cross(z, w), g) - np.array([[float(x.mid()) for x in row] for row in equation.damping])
            largest = np.linalg.eigvalsh((form + form.T) / 2)[-1]
            found = float(growth_rate(equation, zeta))
            assert largest - 1e-12 * abs(largest) <= found <= largest + 1e-10 * np.abs(form).max()


def test_a_form_is_called_positive_only_where_it_is_for_all_that_the_balls_hold():
    with precision(64):
        assert is_positive([[arb(2), arb(1)], [arb(1), arb(1)]])
        assert not is_positive([[arb(1), arb(1)], [arb(1), arb(1)]])
        assert not is_positive([[arb(1), arb(1)], [arb(1), arb(1, 1e-3) + arb(5e-4)]])


@pytest.mark.parametrize("power", [3, 6, 9])
def test_a_vehicle_a_billion_times_as_stiff_takes_few_steps_and_stays_narrow(power):
    vehicle = entries_as_written(scene_path("robotino2"))["vehicle"]
    vehicle["motor"]["torque_constant_Nm_per_A"] *= 10**power
    with precision(160):
        motion = Motion(equation_of(vehicle), Beginning([arb(1), arb(2), arb(3)], [arb(0), arb(0)], arb(0)), 112)
        values = {f"voltage_V[{i}]": Fraction(i, 10**power) for i in (1, 2, 3)}
        end = next(motion.samples([Stretch(Fraction(0), Fraction(1), values)], [Fraction(1)]))
    assert motion.steps_taken < 120
    assert max(float(x.rad()) for x in end.row()) < 1e-20
