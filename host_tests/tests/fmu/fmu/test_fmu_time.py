"""Time: whole internal steps, no drift, and steps that do not fit."""

from __future__ import annotations

import math
import threading

import pytest
from fmu_importer import DISCARD, ERROR, OK, Importer, generic

BOTH = pytest.mark.parametrize("version", [2, 3])


@BOTH
def test_a_communication_step_is_a_whole_number_of_internal_steps(version: int) -> None:
    with Importer(generic(version)) as importer, Importer(generic(version)) as single:
        for each in (importer, single):
            assert each.set("step_s", 0.001) == OK
            each.initialize()
            assert each.set("voltage_V", 3, 4, 5, 6) == OK
        at = 0
        for steps in (1, 7, 10, 100, 3, 250):
            assert importer.step(at * 0.001, steps * 0.001) == OK
            at += steps
        for k in range(at):
            assert single.step(k * 0.001, 0.001) == OK
        assert importer.get("nu_rad_per_s") == single.get("nu_rad_per_s")
        assert importer.get("x_m") == single.get("x_m")


@BOTH
def test_a_step_that_does_not_fit_is_refused_with_both_numbers(version: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", 0.01) == OK
        importer.initialize()
        before = importer.get("x_m")
        assert importer.step(0.0, 0.025) == ERROR
        assert "0.025" in importer.log[-1][2]
        assert "0.01" in importer.log[-1][2]
        assert importer.get("x_m") == before
        assert importer.step(0.0, 0.03) == OK


@BOTH
@pytest.mark.parametrize("step_s", [0.0, -0.1, math.nan, math.inf])
def test_impossible_steps_are_refused(version: int, step_s: float) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.step(0.0, step_s) == ERROR
        assert importer.step(0.0, 0.1) == OK


@BOTH
def test_a_step_from_somewhere_else_is_refused(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize(start_s=5.0)
        assert importer.step(0.0, 0.1) == ERROR
        assert "model is at 5 s" in importer.log[-1][2]
        assert importer.step(5.0, 0.1) == OK


@BOTH
def test_negative_start_times_and_thirds(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize(start_s=-10.0, stop_s=-5.0)
        time = -10.0
        for _ in range(15):
            assert importer.step(time, 1 / 3) == OK
            time += 1 / 3
        assert importer.time() == pytest.approx(-5.0, abs=1e-12)
        assert importer.step(time, 1 / 3) == ERROR
        assert "stop time -5 s" in importer.log[-1][2]


def added_up(importer: Importer, steps: int, step_s: float) -> float:
    """Steps as importers take them that add up their time; where the sum ends."""
    time = 0.0
    for _ in range(steps):
        assert importer.step(time, step_s) == OK
        time += step_s
    return time


@BOTH
@pytest.mark.parametrize("own_s", [0.0, 0.001, 0.01])
def test_an_importer_that_adds_up_its_time_may_end_with_the_remainder(version: int, own_s: float) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", own_s) == OK
        importer.initialize(stop_s=11.0)
        assert importer.set("voltage_V", 3, 4, 5, 6) == OK
        time = added_up(importer, 1100, 0.01)
        before = importer.get("nu_rad_per_s")
        assert 0.0 < 11.0 - time < 1e-9
        assert importer.step(time, 11.0 - time) == OK, importer.log
        assert importer.get("nu_rad_per_s") == before
        assert importer.time() == 11.0


@BOTH
@pytest.mark.parametrize(("own_s", "remainder_s", "status"), [
    (0.01, 1e-8, OK), (0.01, 2e-8, ERROR), (0.001, 2e-9, ERROR), (0.0, 1e-8, OK), (0.0, 2e-8, OK)])
def test_a_remainder_is_no_step_up_to_a_millionth_of_the_internal_step(
        version: int, own_s: float, remainder_s: float, status: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", own_s) == OK
        importer.initialize()
        assert importer.step(0.0, 0.01) == OK
        assert importer.step(0.01, remainder_s) == status
        taken = own_s == 0.0 and remainder_s > 1e-8  # a step of its own size, since any size will do
        assert importer.time() == 0.01 + (remainder_s if taken else 0.0)
        assert importer.step(importer.time(), 0.01) == OK


@BOTH
def test_the_first_step_of_a_run_is_no_remainder(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.step(0.0, 1e-9) == OK
        assert importer.time() == 1e-9


@BOTH
@pytest.mark.parametrize("own_s", [0.0, 0.01])
def test_a_step_beyond_the_stop_time_is_refused_and_the_one_up_to_it_is_taken(version: int, own_s: float) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", own_s) == OK
        importer.initialize(stop_s=0.05)
        for k in range(4):
            assert importer.step(k * 0.01, 0.01) == OK
        assert importer.step(0.04, 0.02) == ERROR
        assert "goes beyond the stop time 0.05 s" in importer.log[-1][2]
        assert importer.step(0.04, 0.01 + 1e-12) == OK
        assert importer.time() == pytest.approx(0.05, abs=2e-12)
        assert importer.step(0.05, 0.01) == ERROR


@BOTH
def test_model_exchange_knows_its_stop_time_too(version: int) -> None:
    with Importer(generic(version), "ModelExchange") as importer:
        importer.initialize(start_s=-1.0, stop_s=10.0)
        importer.must("EnterContinuousTimeMode")
        flags = importer.ffi.new("int[2]" if version == 2 else "bool[2]")
        for time, status in ((5.0, OK), (10.0, OK), (10.0 + 1e-9, OK), (10.001, ERROR), (11.0, ERROR)):
            assert importer.call("SetTime", time) == status
        assert "beyond the stop time 10 s" in importer.log[-1][2]
        importer.must("SetTime", 9.9)
        importer.must("CompletedIntegratorStep", 1, flags, flags + 1)
        for time, status in ((10.2, OK), (10.23, ERROR)):  # a solver steps a fiftieth of the run ahead, and back
            assert importer.call("SetTime", time) == status
        assert importer.call("CompletedIntegratorStep", 1, flags, flags + 1) == ERROR
        assert "CompletedIntegratorStep: 10.2 s is beyond" in importer.log[-1][2]
        importer.must("SetTime", 10.0)
        importer.must("CompletedIntegratorStep", 1, flags, flags + 1)
        assert importer.call("SetTime", 10.001) == ERROR


@BOTH
def test_variable_communication_steps(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", 3, 4, 5, 6) == OK
        exact = [0.1, 0.05, 0.0125, 0.2, 1 / 3, 0.1, 1e-4]
        at = 0.0
        for step_s in exact * 20:
            assert importer.step(at, step_s) == OK
            at += step_s
        assert importer.time() == pytest.approx(math.fsum(exact * 20), abs=1e-14 * 20)


def test_steps_that_differ_by_rounding_only_are_the_same_step() -> None:
    with Importer(generic(3)) as jittered, Importer(generic(3)) as plain:
        for each in (jittered, plain):
            each.initialize()
            assert each.set("voltage_V", 3, 4, 5, 6) == OK
        time = 0.0
        for k in range(1000):
            following = (k + 1) * 0.01
            assert jittered.step(time, following - time) == OK
            time = following
            assert plain.step(k * 0.01, 0.01) == OK
        assert jittered.get("nu_rad_per_s") == plain.get("nu_rad_per_s")
        assert jittered.time() == plain.time() == 10.0


@pytest.mark.nightly
def test_ten_million_steps_do_not_drift() -> None:
    with Importer(generic(3)) as importer:
        assert importer.set("step_s", 1 / 3) == OK
        importer.initialize(start_s=-100.0)
        block, at = 100_000, -100.0
        for _ in range(100):  # 10^7 internal steps; the importer's own sum may drift, ours does not
            assert importer.step(at, block / 3) == OK
            at += block / 3
        assert importer.time() == -100.0 + 10_000_000 * (1 / 3)


@BOTH
def test_a_step_beyond_the_stability_limit_is_discarded_and_a_smaller_one_goes_on(version: int) -> None:
    with Importer(generic(version), logging=True) as importer:
        assert importer.set("method", 1) == OK
        importer.initialize()
        before = importer.get("x_m")
        assert importer.step(0.0, 100.0) == DISCARD
        assert importer.log[-1][1] == "logStatusDiscard"
        assert importer.get("x_m") == before
        assert importer.step(0.0, 0.001) == OK


def test_intermediate_updates_see_every_internal_step_and_may_return_early() -> None:
    seen: list[tuple[float, list[float]]] = []

    def update(_environment, time, set_requested, get_allowed, finished, can_return, requested, early_time):
        assert get_allowed
        assert finished
        seen.append((time, importer.get("x_m")))
        if set_requested:
            assert importer.set("voltage_V", 1.0, 1.0, 1.0, 1.0) == OK
        assert importer.call("Reset") == ERROR
        if len(seen) == 4:
            assert can_return
            requested[0], early_time[0] = True, time

    importer = Importer(generic(3), early_return=True, update=update)
    with importer:
        assert importer.set("step_s", 0.01) == OK
        importer.initialize()
        assert importer.step(0.0, 0.1) == OK
        assert importer.end["early"]
        assert importer.end["time_s"] == 0.04
        assert [time for time, _ in seen] == [0.01, 0.02, 0.03, 0.04]
        assert seen[-1][1] != seen[0][1]
        assert importer.step(0.04, 0.06) == OK
        assert not importer.end["early"]


@BOTH
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_time_or_a_step_that_is_no_number_is_refused_as_none(version: int, value: float) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        for at_s, step_s in ((0.0, value), (value, 0.1)):
            assert importer.step(at_s, step_s) == ERROR
            assert "not finite" in importer.log[-1][2]
            assert "-nan" not in importer.log[-1][2]
        importer.must("Reset")
        if version == 2:
            assert importer.call("SetupExperiment", 0, 0.0, 0.0, 1, math.nan) == ERROR
        else:
            assert importer.call("EnterInitializationMode", False, 0.0, 0.0, True, math.nan) == ERROR
        assert importer.log[-1][2] == "the stop time nan is not finite"


@BOTH
@pytest.mark.parametrize(("own_s", "at_s", "wrong_s", "advised_s"), [
    (0.01, 0.0, 0.003, 0.01), (0.01, 0.0, 0.025, 0.03), (0.01, 0.04, 0.0089, 0.01), (0.04, 0.04, 0.009, None),
    (0.01, 0.02, 0.029, 0.03), (0.02, 0.02, 0.029, 0.02), (1e-300, 0.0, 0.01, None), (0.01, 0.0, 1e-7, 0.01)])
def test_an_advised_step_is_one_that_is_taken(
        version: int, own_s: float, at_s: float, wrong_s: float, advised_s: float | None) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", own_s) == OK
        if own_s < 1e-100:
            assert importer.set("method", 4) == OK
        importer.initialize(stop_s=0.05)
        if at_s:
            assert importer.step(0.0, at_s) == OK
        assert importer.step(at_s, wrong_s) == ERROR
        message = importer.log[-1][2]
        assert ("nearest that is" in message) == (advised_s is not None)
        if advised_s is None:
            assert "cannot be taken in internal steps" in message
        else:
            assert float(message.split("nearest that is: ")[1].removesuffix(" s")) == pytest.approx(advised_s)
            assert importer.step(at_s, float(message.split("nearest that is: ")[1].removesuffix(" s"))) == OK


@BOTH
def test_without_a_step_of_its_own_the_model_takes_no_step_from_somewhere_else(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.step(0.0, 1.0) == OK
        for off_s in (0.5, -0.5, 0.0011, -0.0011):
            assert importer.step(1.0 + off_s, 1.0) == ERROR
            assert "but the model is at 1 s" in importer.log[-1][2]
        assert importer.step(1.0009, 1.0) == OK


@BOTH
def test_what_an_importer_loses_by_adding_up_its_time_for_hours_is_no_step_from_somewhere_else(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        hours_s = 16384.0  # of steps of 1 ms, each of which loses up to half of the last digit of the time
        assert importer.step(0.0, hours_s - 1.0) == OK
        assert importer.step(hours_s - 1.0, 1.0) == OK
        assert importer.step(hours_s, 0.001) == OK
        lost_s = 0.4 * hours_s / 0.001 * 3.6e-12
        assert importer.step(hours_s + 0.001 + lost_s, 0.001) == OK
        assert importer.step(hours_s + 0.002 - 0.0006, 0.001) == ERROR


@BOTH
def test_model_exchange_has_no_time_before_its_start(version: int) -> None:
    with Importer(generic(version), "ModelExchange") as importer:
        importer.initialize(start_s=5.0)
        importer.must("EnterContinuousTimeMode")
        assert importer.call("SetTime", 4.9) == ERROR
        assert importer.log[-1][2] == "SetTime: 4.9 s is before the start time 5 s"
        for time in (5.0, 5.0 - 1e-12, 6.0, 5.5):
            importer.must("SetTime", time)


def test_a_long_step_is_cancelled_by_another_thread_and_taken_back() -> None:
    with Importer(generic(2), logging=True) as importer, Importer(generic(2)) as other:
        for each in (importer, other):
            assert each.set("step_s", 0.001) == OK
            each.initialize()
            assert each.set("voltage_V", 3, 4, 5, 6) == OK

        def cancel() -> None:
            while importer.call("CancelStep") != OK:
                pass

        thread = threading.Thread(target=cancel)
        thread.start()
        assert importer.step(0.0, 90_000.0) == DISCARD
        thread.join()
        assert "the communication step is cancelled after" in importer.log[-1][2]
        assert importer.time() == 0.0
        for each in (importer, other):
            assert each.step(0.0, 0.1) == OK
        assert importer.get("nu_rad_per_s") == other.get("nu_rad_per_s")
        assert importer.get("x_m") == other.get("x_m")


def test_without_a_running_step_there_is_nothing_to_cancel() -> None:
    with Importer(generic(2)) as importer:
        importer.initialize()
        assert importer.call("CancelStep") == ERROR
        assert importer.log[-1][2] == \
            "CancelStep is not allowed in step mode: no step is running; another thread may call it while DoStep runs"
        assert importer.step(0.0, 0.1) == OK


@BOTH
def test_a_step_of_more_internal_steps_than_an_importer_can_wait_for_is_refused(version: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", 0.001) == OK
        importer.initialize()
        assert importer.step(0.0, 1e9) == ERROR
        assert importer.log[-1][2] == (
            "the communication step of 1000000000 s would be 1000000000000 internal steps of 0.001 s (step_s) without "
            "a return: take 100000 s or less")
        assert importer.step(0.0, 0.1) == OK


def test_an_importer_that_may_return_early_ends_a_step_of_any_length() -> None:
    early = []

    def update(_environment, _time, _can_set, _can_get, _finished, can_return, returns, return_time) -> None:
        early.append(can_return)
        returns[0] = len(early) == 3
        return_time[0] = _time

    with Importer(generic(3), early_return=True, update=update) as importer:
        assert importer.set("step_s", 0.001) == OK
        importer.initialize()
        assert importer.step(0.0, 1e9) == OK
        assert importer.end["early"]
        assert importer.end["time_s"] == 0.003


@BOTH
def test_times_that_differ_are_shown_by_digits_that_differ(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize(start_s=1e12)
        assert importer.step(math.nextafter(1e12, math.inf), 1e-6) == ERROR
        assert "the step starts at 1000000000000.0001 s, but the model is at 1000000000000 s" in importer.log[-1][2]
