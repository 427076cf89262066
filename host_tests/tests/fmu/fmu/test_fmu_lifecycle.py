"""The state machine: every call in every mode is taken or refused as in the table of fmu/glue/lifecycle.c."""

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
