"""Directional and adjoint derivatives, output and input derivatives: against central differences and each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmu_friction_scenes import PARTS, friction_scene
from fmu_importer import DISCARD, ERROR, OK, Importer, generic

from laconic.fmu import make_fmu
from laconic.scene import read_scene

STATES = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad")
INPUTS = ("voltage_V", "axle_torque_Nm", "body_force_N", "body_moment_Nm", "world_force_N", "world_force_point_m")
RATES = ("der(nu_rad_per_s)", "der(x_m)", "der(y_m)", "der(heading_rad)", "der(wheel_angle_rad)")
OUTPUTS = (*STATES, "heading_wrapped_rad", "origin_x_m", "origin_y_m", "velocity_body_m_per_s", "yaw_rate_rad_per_s",
           "wheel_speed_rad_per_s", "wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N", "no_slip_margin_N",
           "energy_J", "acceleration_body_m_per_s2")


@pytest.fixture(params=["robotino2", "turtlebot3_burger", "kuka_youbot", "omni_on_a_slope"])
def point(request: pytest.FixtureRequest, tmp_path: Path) -> Importer:
    """A Model Exchange instance at a point where everything acts."""
    scene = friction_scene(request.param, tmp_path) if request.param in PARTS else read_scene(request.param)
    importer = Importer(make_fmu(scene, tmp_path / "x.fmu", version=3), "ModelExchange")
    importer.initialize()
    importer.must("EnterContinuousTimeMode")
    random = np.random.default_rng(3)
    for name in INPUTS:
        assert importer.set(name, *random.uniform(-1, 1, importer.size(name))) == OK
    put(importer, random.uniform(-1, 1, 6 + importer.wheels))
    yield importer
    importer.close()


def put(importer: Importer, states: np.ndarray) -> None:
    """Sets the continuous states."""
    importer.must("SetContinuousStates", importer.ffi.new("double[]", list(states)), len(states))


def row(importer: Importer, names: tuple[str, ...]) -> np.ndarray:
    """All values of some variables."""
    return np.array([value for name in names for value in importer.get(name)])


def directional(importer: Importer, unknowns: tuple[str, ...], knowns: tuple[str, ...], seed: np.ndarray) -> np.ndarray:
    """∂unknowns/∂knowns · seed."""
    count = sum(importer.size(name) for name in unknowns)
    result = importer.ffi.new("double[]", count)
    importer.must("GetDirectionalDerivative", importer.references(*unknowns), len(unknowns),
                  importer.references(*knowns), len(knowns), importer.ffi.new("double[]", list(seed)), len(seed),
                  result, count)
    return np.array(list(result))


def jacobian(importer: Importer, unknowns: tuple[str, ...], knowns: tuple[str, ...]) -> np.ndarray:
    """∂unknowns/∂knowns, column by column."""
    count = sum(importer.size(name) for name in knowns)
    return np.array([directional(importer, unknowns, knowns, column) for column in np.eye(count)]).T


def differences(importer: Importer, unknowns: tuple[str, ...], knowns: tuple[str, ...]) -> np.ndarray:
    """The same by central differences."""
    columns, step = [], 1e-5
    states = np.array(importer.states())
    for name in knowns:
        values = importer.get(name)
        for k in range(len(values)):
            sides = []
            for sign in (1, -1):
                moved = list(values)
                moved[k] += sign * step
                assert importer.set(name, *moved) == OK
                sides.append(row(importer, unknowns))
            assert importer.set(name, *values) == OK
            columns.append((sides[0] - sides[1]) / (2 * step))
    put(importer, states)
    return np.array(columns).T


def test_directional_derivatives_are_the_slopes(point: Importer) -> None:
    unknowns, knowns = RATES + OUTPUTS, STATES + INPUTS
    exact, rough = jacobian(point, unknowns, knowns), differences(point, unknowns, knowns)
    assert np.abs(exact).max() > 0.1
    fixed = [k for k, name in enumerate(n for n in unknowns for _ in range(point.size(n)))
             if name.startswith("nu_rad") and point.get("wheel_lateral_N") != [0.0] * point.wheels]
    rows = [k for k in range(len(exact)) if k not in fixed]
    np.testing.assert_allclose(exact[rows], rough[rows], rtol=1e-6, atol=1e-6 * max(1.0, np.abs(rough).max()))


def test_adjoint_derivatives_are_the_transpose(point: Importer) -> None:
    unknowns, knowns = RATES + OUTPUTS, STATES + INPUTS
    matrix = jacobian(point, unknowns, knowns)
    seed = np.random.default_rng(5).uniform(-1, 1, matrix.shape[0])
    result = point.ffi.new("double[]", matrix.shape[1])
    point.must("GetAdjointDerivative", point.references(*unknowns), len(unknowns), point.references(*knowns),
               len(knowns), point.ffi.new("double[]", list(seed)), len(seed), result, matrix.shape[1])
    np.testing.assert_allclose(list(result), seed @ matrix, rtol=1e-12, atol=1e-12 * np.abs(matrix).max())


def test_what_depends_on_what_is_as_the_description_states(point: Importer) -> None:
    by_reference = {v.valueReference: v.name for v in point.variables.values()}
    for unknown in (*point.description.outputs, *point.description.derivatives):
        name, listed = unknown.variable.name, {v.name for v in unknown.dependencies}
        for known in STATES + INPUTS:
            if known not in listed:
                assert not jacobian(point, (name,), (known,)).any(), f"{name} depends on {known}"
    assert by_reference[0] == "time"


@pytest.mark.parametrize("version", [2, 3])
def test_output_derivatives_are_the_slopes_in_time(version: int) -> None:
    names = ("nu_rad_per_s", "x_m", "heading_rad", "wheel_speed_rad_per_s", "energy_J", "wheel_torque_Nm",
             "wheel_reaction_N", "no_slip_margin_N", "origin_y_m")
    with Importer(generic(version)) as importer:
        assert importer.set("method", 1) == OK
        assert importer.set("world_force_N", 3.0, 1.0) == OK
        assert importer.set("voltage_V", 3.0, 5.0, 4.0, 6.0) == OK
        importer.initialize()
        h, rows = 1e-4, []
        for k in range(2001):
            if k >= 1998:
                rows.append(row(importer, names))
            if k == 1999:
                elements = [e for name in names for e in importer.elements(name)[0]]
                count = sum(importer.size(name) for name in names)
                values = importer.ffi.new("double[]", count)
                orders = importer.ffi.new("int[]" if version == 2 else "int32_t[]", [1] * len(elements))
                function = "GetRealOutputDerivatives" if version == 2 else "GetOutputDerivatives"
                importer.must(function, importer.references(*elements), len(elements), orders, values,
                              *((count,) if version == 3 else ()))
            assert importer.step(k * h, h) == OK
    slopes = (rows[2] - rows[0]) / (2 * h)
    np.testing.assert_allclose(list(values), slopes, rtol=1e-5, atol=1e-5 * np.abs(slopes).max())


def test_fmi2_input_derivatives_interpolate_within_the_step() -> None:
    with Importer(generic(2)) as fine, Importer(generic(2)) as sloped:
        for importer, step_s in ((fine, 1e-4), (sloped, 1e-3)):
            assert importer.set("method", 1) == OK
            assert importer.set("step_s", step_s) == OK
            importer.initialize()
        names = sloped.elements("voltage_V")[0]
        for k in range(20):
            assert sloped.set("voltage_V", *(100 * k * 1e-2,) * 4) == OK
            orders, slopes = sloped.ffi.new("int[]", [1] * 4), sloped.ffi.new("double[]", [100.0] * 4)
            sloped.must("SetRealInputDerivatives", sloped.references(*names), 4, orders, slopes)
            assert sloped.step(k * 1e-2, 1e-2) == OK
        for k in range(2000):  # held at its middle over each of many small steps
            assert fine.set("voltage_V", *(100 * (k + 0.5) * 1e-4,) * 4) == OK
            assert fine.step(k * 1e-4, 1e-4) == OK
        assert sloped.get("voltage_V") == pytest.approx([20.0] * 4, abs=1e-12)
        np.testing.assert_allclose(row(sloped, ("nu_rad_per_s", "x_m")), row(fine, ("nu_rad_per_s", "x_m")), rtol=5e-7,
                                   atol=1e-9)


def test_fmi2_an_input_that_leaves_the_range_within_the_step_is_named() -> None:
    with Importer(generic(2), logging=True) as importer:
        importer.initialize()
        assert importer.set("axle_torque_Nm", 0.0, 0.0, 1e308, 0.0) == OK
        orders, slopes = importer.ffi.new("int[]", [1]), importer.ffi.new("double[]", [1e308])
        importer.must("SetRealInputDerivatives", importer.references("axle_torque_Nm[3]"), 1, orders, slopes)
        assert importer.step(0.0, 1.0) == DISCARD
        assert "axle_torque_Nm[3]: infinity is not a finite number" in importer.log[-1][2]


@pytest.mark.parametrize("version", [2, 3])
def test_what_has_no_derivative_is_refused_by_name(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        one, result = importer.ffi.new("double[]", [1.0]), importer.ffi.new("double[1]")
        more = ((1,), (1,)) if version == 3 else ((), ())
        for unknown, known, named in (("x_m", "mass_kg", "mass_kg"), ("mass_kg", "x_m", "mass_kg")):
            assert importer.call("GetDirectionalDerivative", importer.references(unknown), 1,
                                 importer.references(known), 1, one, *more[0], result, *more[1]) == ERROR
            assert named in importer.log[-1][2]
