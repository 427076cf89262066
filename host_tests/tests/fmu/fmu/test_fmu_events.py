"""Event mode: an iteration in which the continuous states change reports it once, whatever call applied the change."""

from __future__ import annotations

import pytest
from fmu_importer import ERROR, OK, Importer, generic

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
