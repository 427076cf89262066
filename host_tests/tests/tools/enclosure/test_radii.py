"""What the radii promise: whatever starts inside stays inside, bounds are bounds, and closed solutions are held."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import arb

from laconic.base.paths import scene_path
from laconic.scene import read_scene
from laconic.simulation import simulate
from laconic.tools.enclosure.balls import ball, precision, times, widened
from laconic.tools.enclosure.defect import growth_rate, is_positive
from laconic.tools.enclosure.equation import Equation, Stretch, equation_of
from laconic.tools.enclosure.motion import Motion
from laconic.tools.enclosure.readings import entries_as_written
from laconic.tools.enclosure.references import enclose_case, reading_of_case
from laconic.tools.enclosure.state import Beginning, Sample
from laconic.tools.enclosure.study import state_signals, study_of
from laconic.tools.verify.trajectories import read_reference

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
@pytest.mark.parametrize("values", [PUSH, *(pytest.param(each, marks=pytest.mark.nightly) for each in (
    {}, {"body_force_N[1]": Fraction(7), "body_moment_Nm": Fraction(1, 3)}))])
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


# ---- The file's numbers and the core's constants lead to one motion, whatever a vehicle has; the starts may
# differ.

BODY = """[vehicle]
mass_kg = 12.3
yaw_inertia_kgm2 = 0.41
com_x_m = 0.013
com_y_m = -0.021
wheel_radius_m = 0.07
wheel_inertia_kgm2 = 0.0013
"""
SHAFT = """[vehicle.motor]
resistance_ohm = 1.3
torque_constant_Nm_per_A = 0.037
back_emf_Vs_per_rad = 0.041
gear_ratio = 17.3
viscous_friction_Nms = 2.1e-5
rotor_inertia_kgm2 = 1.7e-5
"""
GAIN = "motor_gain_Nm_per_V = 0.31\nmotor_damping_Nms = 0.17\n"
PAYLOAD = """[vehicle.payload]
mass_kg = 3.1
x_m = 0.09
y_m = 0.04
yaw_inertia_kgm2 = 0.023
"""
THREE = "".join(f'[[vehicle.wheel]]\nkind = "omni"\ndistance_m = 0.2{i}\nbearing_deg = {bearing}\n'
                f"axle_deg = {bearing + 3}\n" for i, bearing in enumerate((17, 140, 261)))
ROLLERS = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_rad = -1.5707963267948966\n'
                  f"roller_deg = {45 if x * y > 0 else -45}\n" for x in (0.2, -0.2) for y in (0.17, -0.15))
PAIR = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = 0.01\ny_m = {y}\naxle_deg = -90\n' for y in (0.2, -0.2))
SLOPE = "[ground]\nslope_deg = 7.5\nslope_heading_deg = 30\n"
MOVING = "[initial]\nvelocity_body_m_per_s = [0.3, -0.2]\nyaw_rate_rad_per_s = 0.7\nx_m = 0.1\nheading_deg = 33\n"
VEHICLES = {
    "gain and damping": BODY + GAIN + THREE + MOVING,
    "motor at its shaft, payload": BODY + SHAFT + THREE + PAYLOAD + MOVING,
    "slope": BODY + GAIN + ROLLERS + SLOPE + MOVING,
    "wheels of their own": BODY + SHAFT + THREE + "radius_m = 0.05\ninertia_kgm2 = 0.0007\n" + MOVING,
    "motor of its own": BODY + GAIN + THREE + "motor_gain_Nm_per_V = 0.21\nmotor_damping_Nms = 0.4\n" + PAYLOAD,
    "a wheel without motor": BODY + SHAFT + THREE + "driven = false\n" + MOVING,
    "a locked wheel": BODY + GAIN + ROLLERS + "locked = true\n" + PAYLOAD + SLOPE,
    "fixed wheels": BODY + SHAFT + PAIR + PAYLOAD + SLOPE}
LOADS = (("voltage_V[1]", 2.3), ("voltage_V[2]", -1.1), ("axle_torque_Nm[2]", 0.13), ("body_force_N[1]", 0.9),
         ("body_force_N[2]", -1.7), ("body_moment_Nm", 0.3), ("world_force_N[1]", 1.9), ("world_force_N[2]", -0.8),
         ("world_force_point_m[1]", 0.11), ("world_force_point_m[2]", -0.07))
INPUTS = "".join(f'[[input]]\nsignal = "{signal}"\nkind = "steps"\nt_s = [0.0, 0.2]\nvalue = [{value}, {value / 3}]\n'
                 for signal, value in LOADS)


@pytest.mark.parametrize("name", VEHICLES)
def test_both_readings_of_a_vehicle_agree_to_rounding_and_the_core_with_them(name, tmp_path):
    path = tmp_path / "vehicle.toml"
    path.write_text(f"{VEHICLES[name]}{INPUTS}[run]\nduration_s = 0.5\nstep_s = 0.0005\n[outputs]\nevery_s = 0.25\n")
    scene = read_scene(path)
    study = study_of(simulate(scene, state_signals(scene.wheel_count)), shown=False)
    for found in (study.of_file, study.of_core):
        assert found.width < 1e-20
        assert max(kind.error for kind in found.kinds()) < 1e-11
    for one, other in zip(study.of_file.end.row(), study.of_core.end.row(), strict=True):
        assert float(abs(one - other).upper()) < 1e-13 * max(1.0, abs(float(one)))


# ---- Every reference of 25 digits lies inside its enclosure; a fault put into the equation on purpose is caught.

DATA = Path(__file__).parents[2] / "data"
CASES = {f"{name}/{case.text('name')}": case for name in ("trajectories", "methods", "free_motion")
         for case in read_reference(DATA / f"{name}.json")}
TURNING, PUSHED = CASES["trajectories/omni3-driven-turning"], CASES["trajectories/caster-pushed"]


@pytest.mark.parametrize("name", [name if at % 4 == 0 else pytest.param(name, marks=pytest.mark.nightly)
                                  for at, name in enumerate(CASES)])
def test_a_reference_of_25_digits_lies_inside_an_enclosure_narrower_than_its_last_digit(name):
    found = enclose_case(CASES[name], None)
    assert found.outside == ()
    assert 0.0 < found.enclosed.width < 1e-24


def negative(matrix: list) -> list:
    return [[-x for x in row] for row in matrix]


FAULTS = {
    "gyro": lambda e: replace(e, gyro=[-x for x in e.gyro]),
    "damping": lambda e: replace(e, damping=negative(e.damping)),
    "voltage": lambda e: replace(e, voltage_scale=[-x for x in e.voltage_scale]),
    "heading": lambda e: replace(e, yaw_rate_of_zeta=[-x for x in e.yaw_rate_of_zeta]),
    "place": lambda e: replace(e, velocity_of_zeta=negative(e.velocity_of_zeta)),
    "wheels": lambda e: replace(e, wheel_of_zeta=negative(e.wheel_of_zeta)),
    "one velocity": lambda e: replace(e, velocity_of_zeta=[e.velocity_of_zeta[0], *negative(e.velocity_of_zeta[1:])]),
    "the 23rd digit of the gyroscopic term": lambda e: replace(e, gyro=[x * (1 + arb("1e-22")) for x in e.gyro]),
    "the 23rd digit of a motor": lambda e: replace(e, voltage_scale=[x * (1 + arb("1e-22")) for x in e.voltage_scale])}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_put_into_the_equation_on_purpose_leaves_the_reference_outside(fault):
    whole = reading_of_case(TURNING, FAULTS[fault])
    first = replace(whole, stretches=whole.stretches[:1])  # negative damping has no end
    assert enclose_case(TURNING, None, reading=first).outside


def test_a_force_fixed_in_the_world_that_turns_the_wrong_way_is_caught(monkeypatch):
    from laconic.tools.enclosure import motion

    right = motion.forcing_of

    def wrong(equation: Equation, values: dict) -> object:
        forcing = right(equation, values)
        return replace(forcing, sine=[-x for x in forcing.sine])

    assert not enclose_case(PUSHED, None).outside
    monkeypatch.setattr(motion, "forcing_of", wrong)
    assert enclose_case(PUSHED, None).outside
