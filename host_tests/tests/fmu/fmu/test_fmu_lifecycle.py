"""The state machine: every call in every mode is taken or refused as in the table of fmu/glue/lifecycle.c.

Event mode: an iteration in which the continuous states change reports it once, whatever call applied the change.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest
from fmu_importer import ERROR, OK, Importer, generic

from laconic.base.paths import SOURCE_DIR

MODES = ("INSTANTIATED", "CONFIGURATION", "INITIALIZATION", "EVENT", "CONTINUOUS", "STEP", "TERMINATED")

# What the standards' tables allow (FMI 2.0.4 §3.2.3 and §4.2.4, FMI 3.0.1 §2.3, §3.2, §4.2), by first letters of MODES
# except that CONTINUOUS is X and CONFIGURATION F. Written down here a second time on purpose.
LETTERS = dict(zip("IFNEXST", MODES, strict=True))
ALLOWED = {  # call: FMI 2 ME, FMI 2 CS, FMI 3 ME, FMI 3 CS
    "SetDebugLogging": ("INEXT", "INST", "IFNEXT", "IFNEST"),
    "SetupExperiment": ("I", "I", None, None),
    "EnterConfigurationMode": (None, None, "I", "I"),
    "ExitConfigurationMode": (None, None, "F", "F"),
    "EnterInitializationMode": ("I", "I", "I", "I"),
    "ExitInitializationMode": ("N", "N", "N", "N"),
    "EnterEventMode": ("EX", "", "X", "S"),
    "NewDiscreteStates": ("E", "", None, None),
    "UpdateDiscreteStates": (None, None, "E", "E"),
    "EnterContinuousTimeMode": ("E", "", "E", ""),
    "EnterStepMode": (None, None, "", "E"),
    "Terminate": ("EX", "S", "EX", "ES"),
    "Reset": ("INEXT", "INST", "IFNEXT", "IFNEST"),
    "Get": ("NEXT", "NST", "IFNEXT", "IFNEST"),
    "SetReal": ("INEX", "INS", "INEX", "INES"),
    "GetState": ("INEXT", "INST", "IFNEXT", "IFNEST"),
    "GetDirectionalDerivative": ("NEXT", "NST", "NEXT", "NEST"),
    "SetTime": ("EX", "", "X", ""),
    "SetContinuousStates": ("X", "", "X", ""),
    "GetContinuousStates": ("NEXT", "", "NEXT", ""),
    "GetDerivatives": ("NEXT", "", "NEXT", ""),
    "GetNominals": ("INEXT", "", "NEXT", ""),
    "CompletedIntegratorStep": ("X", "", "X", ""),
    "DoStep": ("", "S", "", "S"),
    "GetOutputDerivatives": ("", "ST", "", "ST"),
}


def in_mode(version: int, kind: str, mode: str) -> Importer | None:
    """A new instance in that mode; None where there is no such mode."""
    exchange = kind == "ModelExchange"
    if (mode == "CONFIGURATION" and version == 2) or (mode == "CONTINUOUS" and not exchange) or \
            (mode == "STEP" and exchange) or (mode == "EVENT" and not exchange and version == 2):
        return None
    importer = Importer(generic(version), kind, event_mode=True)
    if mode == "CONFIGURATION":
        importer.must("EnterConfigurationMode")
    if mode in ("INSTANTIATED", "CONFIGURATION"):
        return importer
    if version == 3:
        importer.must("EnterInitializationMode", False, 0.0, 0.0, False, 0.0)
    else:
        importer.must("EnterInitializationMode")
    if mode == "INITIALIZATION":
        return importer
    importer.must("ExitInitializationMode")
    if mode == "CONTINUOUS":
        importer.must("EnterContinuousTimeMode")
    if mode in ("STEP", "TERMINATED") and version == 3 and not exchange:
        importer.must("EnterStepMode")
    if mode == "TERMINATED":
        importer.must("Terminate")
    return importer


def calls(importer: Importer) -> dict[str, Callable[[], int]]:
    """Each call with sensible arguments."""
    ffi, new, version = importer.ffi, importer.ffi.new, importer.version
    one = new("double *")
    reference = importer.references("mass_kg")
    force = importer.references("body_moment_Nm")
    derivative, nu = ("der(x_m)", "heading_rad")
    states = 6 + importer.wheels
    numbers = new("double[]", states)
    state = new("void **")
    count = (1,) if version == 3 else ()
    plain: dict[str, tuple[Any, ...]] = {
        "SetDebugLogging": (False, 0, ffi.NULL), "EnterConfigurationMode": (), "ExitConfigurationMode": (),
        "ExitInitializationMode": (), "EnterEventMode": (), "EnterContinuousTimeMode": (), "EnterStepMode": (),
        "Terminate": (), "Reset": (), "SetTime": (0.0,), "SetContinuousStates": (numbers, states),
        "GetContinuousStates": (numbers, states)}
    table: dict[str, Callable[[], int]] = {
        name: (lambda name=name, arguments=arguments: importer.call(name, *arguments))
        for name, arguments in plain.items()}
    table["Get"] = lambda: importer.call("GetReal" if version == 2 else "GetFloat64", reference, 1, one, *count)
    table["SetReal"] = lambda: importer.call("SetReal" if version == 2 else "SetFloat64", force, 1, one, *count)
    table["GetState"] = lambda: free_after(importer, state)
    table["GetDerivatives"] = lambda: importer.call(
        "GetDerivatives" if version == 2 else "GetContinuousStateDerivatives", numbers, states)
    table["GetNominals"] = lambda: importer.call("GetNominalsOfContinuousStates", numbers, states)
    table["DoStep"] = lambda: importer.step(0.0, 0.01)
    seed, result = new("double *"), new("double *")
    arguments = (importer.references(derivative), 1, importer.references(nu), 1)
    table["GetDirectionalDerivative"] = lambda: importer.call(
        "GetDirectionalDerivative", *arguments, *((seed, result) if version == 2 else (seed, 1, result, 1)))
    orders = new("int[]", [1])
    table["GetOutputDerivatives"] = lambda: importer.call(
        "GetRealOutputDerivatives" if version == 2 else "GetOutputDerivatives", importer.references("x_m"), 1,
        orders if version == 2 else new("int32_t[]", [1]), one, *count)
    if version == 2:
        flags = new("int[2]")
        table["SetupExperiment"] = lambda: importer.call("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        table["EnterInitializationMode"] = lambda: importer.call("EnterInitializationMode")
        table["NewDiscreteStates"] = lambda: importer.call("NewDiscreteStates", new("fmi2EventInfo *"))
        table["CompletedIntegratorStep"] = lambda: importer.call("CompletedIntegratorStep", 1, flags, flags + 1)
    else:
        bits = new("bool[5]")
        table["EnterInitializationMode"] = lambda: importer.call("EnterInitializationMode", False, 0.0, 0.0, False, 0.0)
        table["UpdateDiscreteStates"] = lambda: importer.call(
            "UpdateDiscreteStates", bits, bits + 1, bits + 2, bits + 3, bits + 4, one)
        table["CompletedIntegratorStep"] = lambda: importer.call("CompletedIntegratorStep", True, bits, bits + 1)
    return table


def free_after(importer: Importer, state: Any) -> int:
    """GetFMUState and, when it was given, FreeFMUState."""
    suffix = "FMUstate" if importer.version == 2 else "FMUState"
    status = importer.call(f"Get{suffix}", state)
    if status == OK:
        importer.must(f"Free{suffix}", state)
    return status


CASES = [(version, kind) for version in (2, 3) for kind in ("ModelExchange", "CoSimulation")]


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("version", "kind"), CASES)
def test_each_call_is_taken_or_refused_as_the_standard_states(version: int, kind: str, mode: str) -> None:
    column = CASES.index((version, kind))
    for call, columns in ALLOWED.items():
        allowed = columns[column]
        importer = in_mode(version, kind, mode)
        if importer is None or allowed is None:
            continue
        with importer:
            status = calls(importer)[call]()
            wanted = OK if mode in {LETTERS[letter] for letter in allowed} else ERROR
            assert status == wanted, f"{call} in {mode}: status {status}, log {importer.log}"
            if wanted == ERROR:
                assert "not allowed" in importer.log[-1][2], importer.log


def test_every_call_of_the_table_was_walked() -> None:
    source = (SOURCE_DIR / "fmu" / "glue" / "lifecycle.h").read_text(encoding="utf-8")
    in_table = set(re.findall(r"FMU_CALL_(\w+)", source)) - {"COUNT"}
    walked = {"SET_DEBUG_LOGGING", "SETUP_EXPERIMENT", "ENTER_CONFIGURATION", "EXIT_CONFIGURATION",
              "ENTER_INITIALIZATION", "EXIT_INITIALIZATION", "ENTER_EVENT", "UPDATE_DISCRETE_STATES",
              "ENTER_CONTINUOUS_TIME", "ENTER_STEP", "TERMINATE", "RESET", "GET", "SET_CONTINUOUS", "STATE_OF_FMU",
              "PARTIAL_DERIVATIVE", "SET_TIME", "SET_STATES", "GET_STATES", "GET_RATES", "GET_NOMINALS",
              "COMPLETED_STEP", "DO_STEP", "OUTPUT_DERIVATIVES"}
    elsewhere = {"SET_DISCRETE", "DEPENDENCIES", "COUNT_STATES", "CANCEL_STEP", "STEP_STATUS", "INPUT_DERIVATIVES"}
    assert in_table == walked | elsewhere


@pytest.mark.parametrize("version", [2, 3])
def test_reset_brings_back_the_start_values(version: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("mass_kg", 50.0) == OK
        importer.initialize()
        assert importer.step(0.0, 0.1) == OK
        importer.must("Reset")
        importer.initialize()
        assert importer.get("mass_kg") == [24.0]
        assert importer.get("x_m") == [0.0]


@pytest.mark.parametrize("version", [2, 3])
def test_a_null_instance_is_an_error_not_a_crash(version: int) -> None:
    with Importer(generic(version)) as importer:
        null = importer.ffi.NULL
        assert importer.function("Terminate")(null) == ERROR
        assert importer.function("Reset")(null) == ERROR
        importer.function("FreeInstance")(null)


def test_status_of_a_synchronous_fmi2_step() -> None:
    with Importer(generic(2)) as importer:
        importer.initialize()
        assert importer.step(0.0, 0.25) == OK
        real, flag = importer.ffi.new("double *"), importer.ffi.new("int *")
        assert importer.call("GetRealStatus", 2, real) == OK
        assert real[0] == 0.25
        assert importer.call("GetBooleanStatus", 3, flag) == OK
        assert flag[0] == 0
        assert importer.call("GetStatus", 0, importer.ffi.new("fmi2Status *")) == 2
        assert importer.call("CancelStep") == ERROR


KINDS = pytest.mark.parametrize(("version", "kind"), [
    (2, "ModelExchange"), (3, "ModelExchange"), (3, "CoSimulation")])


def states_changed(importer: Importer) -> bool:
    """Ends an event iteration; whether it reports a change of the continuous states."""
    if importer.version == 2:
        event = importer.ffi.new("fmi2EventInfo *")
        importer.must("NewDiscreteStates", event)
        return bool(event.valuesOfContinuousStatesChanged)
    flags, time = importer.ffi.new("bool[5]"), importer.ffi.new("double *")
    importer.must("UpdateDiscreteStates", *(flags + k for k in range(5)), time)
    return bool(flags[3])


def in_event(version: int, kind: str) -> Importer:
    """A vehicle that moves, in an event after the first iteration."""
    importer = Importer(generic(version), kind, event_mode=True)
    assert importer.set("payload_mass_kg", 5.0) == OK
    assert importer.set("payload_x_m", 0.1) == OK
    assert importer.set("start_nu_rad_per_s", 2.0, 0.0, 1.0) == OK
    importer.initialize()
    assert not states_changed(importer)
    return importer


def read(importer: Importer, what: str) -> list[float]:
    """An output, or the vector of continuous states where there is one."""
    if what == "states" and importer.kind == "ModelExchange":
        return importer.states()
    return importer.get("x_m" if what == "states" else what)


@KINDS
@pytest.mark.parametrize("what", [None, "x_m", "energy_J", "nu_rad_per_s", "states"])
def test_a_changed_parameter_is_reported_once_even_if_a_value_is_read_first(
        version: int, kind: str, what: str | None) -> None:
    with in_event(version, kind) as importer:
        before = importer.get("nu_rad_per_s") + importer.get("x_m")
        assert importer.set("payload_mass_kg", 0.0) == OK
        if what:
            read(importer, what)
        assert states_changed(importer)
        assert importer.get("nu_rad_per_s") + importer.get("x_m") != before
        assert not states_changed(importer)


@KINDS
def test_a_change_that_is_refused_changes_no_states_and_the_mended_one_does(version: int, kind: str) -> None:
    with in_event(version, kind) as importer:
        assert importer.set("payload_mass_kg", 1e308) == OK
        flags = importer.ffi.new("double[8]")
        name = "Real" if version == 2 else "Float64"
        more = (1,) if version == 3 else ()
        assert importer.call(f"Get{name}", importer.references("x_m"), 1, flags, *more) == ERROR
        assert importer.set("payload_mass_kg", 0.0) == OK
        importer.get("x_m")
        assert states_changed(importer)


@KINDS
def test_an_iteration_without_a_change_reports_none(version: int, kind: str) -> None:
    with in_event(version, kind) as importer:
        importer.get("energy_J")
        assert not states_changed(importer)


@pytest.mark.parametrize("version", [2, 3])
def test_a_state_that_is_set_in_an_event_is_reported(version: int) -> None:
    with in_event(version, "ModelExchange") as importer:
        assert importer.set("x_m", 3.0) == OK
        assert states_changed(importer)
        assert not states_changed(importer)
        assert importer.states()[3] == 3.0


@KINDS
def test_a_saved_event_reports_what_it_had_to_report(version: int, kind: str) -> None:
    suffix = "FMUstate" if version == 2 else "FMUState"
    with in_event(version, kind) as importer:
        state = importer.ffi.new("void **")
        assert importer.set("payload_mass_kg", 0.0) == OK
        importer.get("x_m")
        importer.must(f"Get{suffix}", state)
        assert states_changed(importer)
        importer.must(f"Set{suffix}", state[0])
        assert states_changed(importer)
        importer.must(f"Free{suffix}", state)
