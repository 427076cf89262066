"""Refusals name the variable, use the core's own words, and never harm a printf-like logger."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from fmu_importer import ERROR, OK, WARNING, Importer, generic

from laconic.fmu import make_fmu
from laconic.scene import read_scene

BOTH = pytest.mark.parametrize("version", [2, 3])


def refused_at_exit(importer: Importer) -> str:
    """Initializes a vehicle that cannot start; the last message of its log."""
    if importer.version == 2:
        importer.must("EnterInitializationMode")
    else:
        importer.must("EnterInitializationMode", False, 0.0, 0.0, False, 0.0)
    assert importer.call("ExitInitializationMode") == ERROR
    return importer.log[-1][2]


@BOTH
@pytest.mark.parametrize("name", ["mass_kg", "wheel_radius_m", "yaw_inertia_kgm2"])
def test_parameters_that_cannot_be_are_refused_by_the_core_with_the_fields_name(version: int, name: str) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set(name, 0.0) == OK
        message = refused_at_exit(importer)
        assert name in message
        assert importer.set(name, 1.0) == OK
        importer.must("ExitInitializationMode")


@BOTH
@pytest.mark.parametrize(("name", "value", "message"), [
    ("mass_kg", -1.0, "-1 is outside its range: at least 0"), ("wheel_inertia_kgm2", -1.0, "at least 0"),
    ("com_z_m", -5.0, "at least 0"), ("payload_mass_kg", -2.0, "at least 0"), ("step_s", -1e-3, "at least 0"),
    ("friction_coefficient", -0.1, "at least 0"), ("method", 17, "17 is outside its range: 0 to 7"),
    ("method", -1, "0 to 7"), ("support_count", 9, "0 to 4"), ("motor_damping_Nms", math.nan, "not a finite number")])
def test_a_parameter_outside_its_declared_range_is_refused_when_it_is_set(
        version: int, name: str, value: float, message: str) -> None:
    with Importer(generic(version)) as importer:
        if version == 3:
            before = importer.get(name)
        assert importer.set(name, value) == ERROR
        assert importer.log[-1][2].startswith(f"{name}: ")
        assert message in importer.log[-1][2]
        if version == 3:
            assert importer.get(name) == before
        importer.initialize()


@BOTH
def test_a_wheel_whose_rollers_lie_along_its_axle_is_named(version: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("roller_rad", -0.7, 0.7, 0.0, -0.7) == OK
        message = refused_at_exit(importer)
        assert "roller_rad" in message
        assert "3" in message


def test_more_wheels_than_were_set_are_refused() -> None:
    with Importer(generic(3)) as importer:
        importer.must("EnterConfigurationMode")
        assert importer.set("wheel_count", 6) == OK
        importer.must("ExitConfigurationMode")
        importer.wheels = 6
        message = refused_at_exit(importer)
        assert "wheel_kind" in message
        assert "5" in message
        for name, values in (("wheel_kind", [1] * 6), ("wheel_x_m", [0.2, 0.2, 0, 0, -0.2, -0.2]),
                             ("wheel_y_m", [0.1, -0.1] * 3), ("axle_rad", [-math.pi / 2] * 6),
                             ("roller_rad", [0.7, -0.7] * 3), ("wheel_locked", [False] * 6)):
            assert importer.set(name, *values) == OK
        importer.must("ExitInitializationMode")
        assert len(importer.get("wheel_speed_rad_per_s")) == 6
        assert importer.step(0.0, 0.1) == OK


@pytest.mark.parametrize(("name", "more"), [("robotino2", 1), ("turtlebot3_burger", 2)])
def test_wheels_beyond_those_of_a_scene_are_unset_and_no_wheels_of_another_robot(
        name: str, more: int, tmp_path: Path) -> None:
    with Importer(make_fmu(read_scene(name), tmp_path / "x.fmu", version=3)) as importer:
        first = importer.wheels + 1
        importer.wheels += more
        importer.must("EnterConfigurationMode")
        assert importer.set("wheel_count", importer.wheels) == OK
        importer.must("ExitConfigurationMode")
        for each in ("wheel_kind", "wheel_x_m", "wheel_y_m", "axle_rad"):
            assert importer.get(each)[first - 1:] == [0] * more
        message = refused_at_exit(importer)
        assert f"wheel_kind[{first}]: this wheel was never set" in message


@pytest.mark.parametrize(("count", "shown"), [(0, "0"), (17, "17"), (1 << 40, "1099511627776"), ((1 << 64) - 1, "-1")])
def test_a_wheel_count_that_does_not_fit_is_refused_at_once_as_it_was_given(count: int, shown: str) -> None:
    with Importer(generic(3)) as importer:
        importer.must("EnterConfigurationMode")
        assert importer.set("wheel_count", count) == ERROR
        assert importer.log[-1][2] == f"wheel_count: {shown} is outside its range: 1 to 16"


def test_scalar_fmus_have_no_configuration_mode(tmp_path: Path) -> None:
    with Importer(make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=3, scalar=True)) as importer:
        assert importer.call("EnterConfigurationMode") == ERROR
        assert importer.get("wheel_count") == [3]


@BOTH
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused_with_the_elements_name(version: int, value: float) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", 1.0, value, 2.0, 3.0) == ERROR
        assert "voltage_V[2]" in importer.log[-1][2]
        assert importer.get("voltage_V") == [0.0] * 4
        assert importer.set("body_moment_Nm", value) == ERROR
        assert importer.log[-1][2].startswith("body_moment_Nm:")


@BOTH
def test_wrong_references_types_and_sizes_are_refused(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        double, kind = importer.ffi.new("double[64]"), "Real" if version == 2 else "Float64"
        fifth = importer.variables["x_m"].valueReference * 1024 + 5
        for reference, named in ((900, "900"), (fifth, str(fifth)), (fifth - 5, str(fifth - 5))):
            array = importer.ffi.new(f"fmi{version}ValueReference[]", [reference])
            assert importer.call(f"Get{kind}", array, 1, double, *((1,) if version == 3 else ())) == ERROR
            assert named in importer.log[-1][2]
        method = importer.references("method")
        assert importer.call(f"Get{kind}", method, 1, double, *((1,) if version == 3 else ())) == ERROR
        assert "method is an Enumeration" in importer.log[-1][2]
        if version == 3:
            array = importer.references("nu_rad_per_s")
            assert importer.call("GetFloat64", array, 1, double, 2) == ERROR
            assert importer.call("GetFloat64", array, 1, double, 4) == ERROR
            assert importer.call("GetFloat64", importer.ffi.NULL, 1, double, 1) == ERROR
            assert importer.call("GetFloat32", array, 1, importer.ffi.new("float[3]"), 3) == ERROR


@BOTH
def test_fixed_parameters_and_outputs_cannot_be_set_during_a_run(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        for name, why in (("mass_kg", "fixed"), ("x_m", "state"), ("energy_J", "computed")):
            assert importer.set(name, 1.0) == ERROR
            assert importer.log[-1][2].startswith(f"{name} cannot be set")
            assert why in importer.log[-1][2]


@BOTH
def test_a_foreign_token_is_refused(version: int) -> None:
    importer = Importer(generic(version), token="{nobody-knows-me-%s%n}")
    assert importer.instance == importer.ffi.NULL
    assert "{nobody-knows-me-" in importer.log[-1][2]
    importer.close()


@BOTH
def test_a_scene_fmu_without_its_resources_is_refused(version: int, tmp_path: Path) -> None:
    fmu = make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=version)
    importer = Importer(fmu, resources=tmp_path / "nowhere")
    assert importer.instance == importer.ffi.NULL
    assert f"{tmp_path}/nowhere/start.bin holds no start values" in importer.log[-1][2]
    importer.close()


@BOTH
def test_an_instance_without_a_name_or_a_token_is_refused_with_a_line(version: int) -> None:
    for given, message in (({"name": ""}, "no name (an empty text)"), ({"name": None}, "no name (NULL)"),
                        ({"token": None}, "token is missing (NULL)")):
        importer = Importer(generic(version), **given)
        assert importer.instance == importer.ffi.NULL
        assert message in importer.log[-1][2]
        importer.close()


@pytest.mark.parametrize(("wanted", "message"), [
    ((31, 51), None), ((31, 777), "777"), ((2,), "mass_kg"), (None, "NULL")])
def test_intermediate_variables_that_have_no_intermediate_update_are_refused(wanted, message) -> None:
    importer = Importer(generic(3), update=lambda *_: None, intermediate=wanted)
    assert (importer.instance == importer.ffi.NULL) == bool(message)
    assert message is None or message in importer.log[-1][2]
    importer.close()


def test_resources_are_found_in_folders_with_spaces_and_umlauts(tmp_path: Path) -> None:
    folder = tmp_path / "a b %20 ü"
    folder.mkdir()
    for version in (2, 3):
        fmu = make_fmu(read_scene("robotino2"), tmp_path / f"{version}.fmu", version=version)
        with Importer(fmu) as first:
            (folder / "start.bin").write_bytes((first.folder / "resources" / "start.bin").read_bytes())
        with Importer(fmu, resources=folder) as importer:
            importer.initialize()
            assert importer.wheels == 3


def test_percent_signs_reach_a_printf_like_logger_doubled() -> None:
    with Importer(generic(2), token="{100%s}") as importer:
        assert "{100%%s}" in importer.log[-1][2]


@BOTH
def test_log_categories_are_honoured(version: int) -> None:
    with Importer(generic(version), logging=True) as importer:
        importer.initialize()
        assert importer.set("payload_mass_kg", 1.0) == OK
        assert importer.step(0.0, 0.1) == OK
        assert [category for _, category, _ in importer.log] == ["logEvents"]
        importer.must("SetDebugLogging", 0, 0, importer.ffi.NULL)
        assert importer.set("payload_mass_kg", 2.0) == OK
        assert importer.step(0.1, 0.1) == OK
        assert len(importer.log) == 1
        name = importer.ffi.new("char[]", b"logEvents")
        importer.must("SetDebugLogging", 1, 1, importer.ffi.new("const char *[]", [name]))
        assert importer.set("payload_mass_kg", 3.0) == OK
        assert importer.step(0.2, 0.1) == OK
        assert len(importer.log) == 2
        unknown = importer.ffi.new("char[]", b"log%nonsense")
        assert importer.call("SetDebugLogging", 1, 1, importer.ffi.new("const char *[]", [unknown])) == WARNING
        assert len(importer.log) == 3
        assert "there is no category 'log%" in importer.log[-1][2]


@BOTH
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_payload_during_the_run_keeps_the_bodys_motion(version: int, kind: str) -> None:
    names = ("origin_x_m", "origin_y_m", "heading_rad", "yaw_rate_rad_per_s")
    with Importer(generic(version), kind, event_mode=True) as importer:
        assert importer.set("start_nu_rad_per_s", 5.0, 2.0, 3.0) == OK
        importer.initialize()
        if kind == "CoSimulation" and version == 3:
            importer.must("EnterStepMode")
            assert importer.set("payload_mass_kg", 1.0) == ERROR
            assert importer.step(0.0, 0.1) == OK
            importer.must("EnterEventMode")
        before = [importer.get(name)[0] for name in names]
        point = body_velocity_of_origin(importer)
        for name, value in (("payload_mass_kg", 6.0), ("payload_x_m", 0.1), ("payload_y_m", 0.05)):
            assert importer.set(name, value) == OK
        assert update(importer, kind)
        np.testing.assert_allclose([importer.get(name)[0] for name in names], before, atol=1e-14)
        np.testing.assert_allclose(body_velocity_of_origin(importer), point, atol=1e-14)
        assert importer.get("x_m")[0] != before[0]


def body_velocity_of_origin(importer: Importer) -> list[float]:
    """The velocity of the body's origin in the world: that of S and what turning adds."""
    dx, dy = importer.get("der(x_m)")[0], importer.get("der(y_m)")[0]
    rate = importer.get("yaw_rate_rad_per_s")[0]
    rx = importer.get("origin_x_m")[0] - importer.get("x_m")[0]
    ry = importer.get("origin_y_m")[0] - importer.get("y_m")[0]
    return [dx - rate * ry, dy + rate * rx]


def update(importer: Importer, kind: str) -> bool:
    """Lets the parameters take effect; whether the states changed by that."""
    ffi = importer.ffi
    if importer.version == 2 and kind == "CoSimulation":
        return True
    if importer.version == 2:
        info = ffi.new("fmi2EventInfo *")
        importer.must("NewDiscreteStates", info)
        return bool(info.valuesOfContinuousStatesChanged)
    flags = ffi.new("bool[5]")
    importer.must("UpdateDiscreteStates", flags, flags + 1, flags + 2, flags + 3, flags + 4, ffi.new("double *"))
    return bool(flags[3])


@BOTH
def test_a_changed_vehicle_that_cannot_be_is_refused_and_can_be_mended(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.step(0.0, 0.1) == OK
        assert importer.set("motor_damping_Nms", 1e308) == OK
        assert importer.step(0.1, 0.1) == ERROR
        assert "the changed vehicle is refused" in importer.log[-1][2]
        assert importer.set("motor_damping_Nms", 0.1) == OK
        assert importer.step(0.1, 0.1) == OK


def test_states_can_be_set_one_by_one_in_fmi3_model_exchange() -> None:
    with Importer(generic(3), "ModelExchange") as importer:
        importer.initialize()
        importer.must("EnterContinuousTimeMode")
        assert importer.set("x_m", 7.0) == OK
        assert importer.set("nu_rad_per_s", 1.0, 2.0, 3.0) == OK
        assert importer.states() == [1.0, 2.0, 3.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        assert importer.get("origin_x_m") == [7.0]


def test_an_unknown_kind_of_fmu_is_refused_with_a_line() -> None:
    with Importer(generic(2)) as importer:
        ffi, functions = importer.ffi, importer._keep[-1]
        name, token = ffi.new("char[]", b"x"), ffi.new("char[]", importer.description.guid.encode())
        assert importer.library.fmi2Instantiate(name, ffi.cast("int", 7), token, ffi.NULL, functions, 0, 0) == ffi.NULL
        assert "no such fmuType" in importer.log[-1][2]


@pytest.mark.parametrize(("count", "shown"), [
    (1 << 63, "9.22337203685478e+18"), ((1 << 64) - (1 << 32), "1.84467440694146e+19"), ((1 << 64) - 7, "-7")])
def test_a_large_wheel_count_is_shown_as_it_was_given(count: int, shown: str) -> None:
    with Importer(generic(3)) as importer:
        importer.must("EnterConfigurationMode")
        assert importer.set("wheel_count", count) == ERROR
        assert importer.log[-1][2] == f"wheel_count: {shown} is outside its range: 1 to 16"


UNTOUCHED = 77.0


@BOTH
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_result_beyond_double_precision_is_refused_and_nothing_handed_out(version: int, kind: str) -> None:
    with Importer(generic(version), kind) as importer:
        importer.initialize()
        real, largest = ("Real" if version == 2 else "Float64"), 1.7e308
        assert importer.set("voltage_V", largest, -largest, largest, largest) == OK
        for name in ("no_slip_margin_N", "der(nu_rad_per_s)", "wheel_lateral_N", "wheel_reaction_N"):
            names, _ = importer.elements(name)
            names = ["x_m", *names]
            size = 1 + importer.size(name)
            values = importer.ffi.new("double[]", [UNTOUCHED] * size)
            more = (size,) if version == 3 else ()
            status = importer.call(f"Get{real}", importer.references(*names), len(names), values, *more)
            if status == OK:
                assert all(math.isfinite(value) for value in values)
                assert name.startswith("wheel")
                continue
            assert status == ERROR
            assert "leaves the range of double precision" in importer.log[-1][2]
            assert importer.log[-1][2].startswith(name.removesuffix(")"))
            assert list(values) == [UNTOUCHED] * size
        if kind == "ModelExchange":
            values = importer.ffi.new("double[]", [UNTOUCHED] * 10)
            call = "GetDerivatives" if version == 2 else "GetContinuousStateDerivatives"
            assert importer.call(call, values, 10) == ERROR
            assert "derivative of continuous state 1 of 10 leaves the range" in importer.log[-1][2]
            assert list(values) == [UNTOUCHED] * 10
        assert importer.set("voltage_V", 1.0, 1.0, 1.0, 1.0) == OK
        importer.get("no_slip_margin_N")
        importer.get("der(nu_rad_per_s)")


@BOTH
def test_a_refused_call_hands_out_and_sets_none_of_its_values(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize() if version == 2 else None
        real, whole, c_type = ("Real", "Integer", "int") if version == 2 else ("Float64", "Int32", "int32_t")
        nobody = importer.ffi.new(f"fmi{version}ValueReference[]", [importer.variables["mass_kg"].valueReference, 999])
        values = importer.ffi.new("double[]", [UNTOUCHED] * 2)
        more = (2,) if version == 3 else ()
        assert importer.call(f"Get{real}", nobody, 2, values, *more) == ERROR
        assert list(values) == [UNTOUCHED] * 2
        count = importer.variables["support_count"].valueReference
        nobody = importer.ffi.new(f"fmi{version}ValueReference[]", [count, 999])
        numbers = importer.ffi.new(f"{c_type}[]", [7, 7])
        assert importer.call(f"Get{whole}", nobody, 2, numbers, *more) == ERROR
        assert list(numbers) == [7, 7]
    with Importer(generic(version)) as importer:
        both = importer.ffi.new(f"fmi{version}ValueReference[]", [count, count])
        assert importer.call(f"Set{whole}", both, 2, importer.ffi.new(f"{c_type}[]", [1, 9]), *more) == ERROR
        importer.initialize()
        assert importer.get("support_count") == [0]
