"""Instructions, stack and bytes of an explicit step stay where docs/performance.md has them: the same on every run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.errors import BadInput
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report import filter_cost, peers, step_cost
from laconic.tools.report.accuracy import Truth, follow
from laconic.tools.report.boards import board_row
from laconic.tools.report.counting import cachegrind_present, host_instructions
from laconic.tools.report.workshop import HOST, M4F, Target, Variant, Workshop
from laconic.tools.verify.reference import reference_states

HOST_MOST = {("double", "whole"): 593, ("double", "trimmed"): 582, ("single", "whole"): 575}
BOARD_MOST = {  # bytes
    ("-O2", "whole"): {"instructions": 461, "stack_measured": 168, "worst_stack": 496, "step_code": 4600},
    ("-Os", "trimmed"): {"instructions": 428, "stack_measured": 168, "worst_stack": 176, "step_code": 1760}}

needs_counter = pytest.mark.skipif(not (HOST.present and cachegrind_present()), reason="no gcc or no valgrind")
needs_board = pytest.mark.skipif(not (M4F.present and HOST.present), reason="no gcc or QEMU for Cortex-M")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("figures"))


def explicit(real: str, *, trim: bool, step_s: float, optimisation: str = "-O2") -> Variant:
    return Variant(read_scene("s1").with_run(method=EXPLICIT, step_s=step_s), real, optimisation, trim)


@pytest.mark.nightly
def test_what_a_measurement_lacks_is_named_with_its_remedy(monkeypatch: pytest.MonkeyPatch):
    none = Target("none", "no-such-")
    assert none.missing == "no-such-gcc with its C library, which comes apart: install both" and not none.present
    assert Target("board", "no-such-", machine="none").missing.startswith(("qemu-system-arm: install", "no-such-gcc"))
    monkeypatch.setattr(step_cost, "HOST", none)
    with pytest.raises(BadInput, match=r"^what: step needs no-such-gcc with its C library, which comes apart: install"):
        step_cost.rows(1)


@pytest.mark.nightly
@needs_counter
@pytest.mark.parametrize(("real", "build"), list(HOST_MOST))
def test_instructions_of_a_step_on_the_host(workshop: Workshop, capsys: pytest.CaptureFixture[str], real: str,
                                            build: str):
    found = host_instructions(workshop.host_program(explicit(real, trim=build == "trimmed", step_s=0.01)))
    with capsys.disabled():
        print(f"\nrk4, {real}, {build}: {found:.1f} instructions a step")
    assert 400 < found < HOST_MOST[real, build]


@pytest.mark.nightly
@needs_counter
def test_a_trimmed_step_is_close_to_a_kernel_written_by_hand(workshop: Workshop, capsys: pytest.CaptureFixture[str]):
    rows = {row["who"]: row for row in step_cost.rows_of(workshop, rounds=1)}
    counts = {who: row["instructions"] for who, row in rows.items()}
    with capsys.disabled():
        print(f"\n{counts}")
    assert [row["same_bits"] for row in rows.values()] == ["yes"] * 4
    assert counts["trimmed core"] <= 1.1 * counts["by hand"]
    assert counts["by hand, refuses nothing"] < counts["by hand"]


@pytest.mark.nightly
@needs_board
@pytest.mark.parametrize(("optimisation", "build"), list(BOARD_MOST))
def test_figures_of_a_step_on_a_cortex_m4f(workshop: Workshop, capsys: pytest.CaptureFixture[str], optimisation: str,
                                           build: str):
    most = BOARD_MOST[optimisation, build]
    variant = explicit("single", trim=build == "trimmed", step_s=0.001, optimisation=optimisation)
    row = board_row(workshop, M4F, variant)
    with capsys.disabled():
        print(f"\nrk4, Cortex-M4F, {optimisation}, {build}: " + ", ".join(f"{name} {row[name]}" for name in most))
    assert row["same_bits"]
    for name, bound in most.items():
        assert 0 < row[name] <= bound, name


# ---- The Kalman filter on an emulated Cortex-M4F: its bits are this machine's, and what a cycle costs is printed.

MOST = {"predict": 27_000, "encoders": 7_000, "yaw_rate": 3_500}  # instructions, of three wheels, explicit
MOST_STACK, MOST_FLASH, MOST_RAM = 3_000, 30_000, 2_048           # bytes, of one method
MOST_WHOLE = 115_000                                              # of all methods


@pytest.mark.nightly
@pytest.mark.skipif(not M4F.present, reason="no cross compiler or no qemu-system-arm")
def test_the_filter_has_this_machine_s_bits_on_a_cortex_m4f_and_its_cost_is_printed(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT, step_s=filter_cost.STEP_S)
    cost = filter_cost.cost_of(Workshop(tmp_path), scene)
    with capsys.disabled():
        parts = ", ".join(f"{filter_cost.PARTS[part]} {count:.0f}" for part, count in cost.instructions.items())
        print(f"\n  Kalman filter on a Cortex-M4F, instructions: {parts}; stack {cost.stack_bytes} B, flash "
              f"{cost.flash_bytes} B (all methods: {cost.whole_flash_bytes} B), RAM {cost.filter_bytes} B")
    assert cost.same_bits
    assert all(1_000 < count < MOST[part] for part, count in cost.instructions.items())
    assert cost.stack_bytes < MOST_STACK and cost.flash_bytes < MOST_FLASH and cost.filter_bytes < MOST_RAM
    assert 3 * cost.flash_bytes < cost.whole_flash_bytes < MOST_WHOLE


@pytest.mark.nightly
def test_another_reading_gives_other_bits(tmp_path: Path) -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT, step_s=filter_cost.STEP_S)
    recording = filter_cost.recorded(scene, "single")
    before = recording.estimate(scene)
    recording.turned_rad[50, 1] += 1e-4
    assert recording.estimate(scene) != before


# ---- Other integrators, where they are installed, agree with the core: so both sides of a comparison are right.

needs_peers = pytest.mark.skipif(not HOST.present, reason="no gcc here")


MISSING = peers.missing_peers()


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene("s1").with_run(step_s=0.01, duration_s=3.0)


@pytest.fixture(scope="module")
def truth(scene: Scene) -> Truth:
    ends = np.cumsum(peers.course_of(scene).durations_s)
    return Truth(ends, reference_states(scene, ends))


@needs_peers
@pytest.mark.skipif("casadi" in MISSING, reason="CasADi is not installed")
def test_casadis_rk4_and_ours_take_the_same_velocities_to_rounding(scene: Scene, tmp_path: Path):
    casadi = peers.CasadiRk4(peers.course_of(scene), 100, tmp_path)
    ours = follow(scene.with_run(method=EXPLICIT), "double", np.array([1.7]))[0]
    np.testing.assert_allclose(ours[:3], casadi.state_after(170)[:3], rtol=1e-12, atol=1e-13)


@needs_peers
@pytest.mark.skipif(any("CVODE" in name for name in MISSING), reason="SUNDIALS CVODE is not installed")
@pytest.mark.parametrize("bdf", [False, True], ids=["Adams", "BDF"])
def test_cvode_from_c_reaches_the_reference(scene: Scene, truth: Truth, tmp_path: Path, bdf: bool):
    states = peers.cvode_runner(peers.course_of(scene), tmp_path)(bdf, 1e-9).states
    assert np.max(np.abs(states - truth.states)) < 1e-5


@needs_peers
@pytest.mark.skipif("numbalsoda" in MISSING, reason="numbalsoda is not installed")
@pytest.mark.parametrize("compiled_rhs", [True, False], ids=["C", "numba"])
def test_compiled_dop853_reaches_the_reference(scene: Scene, truth: Truth, tmp_path: Path, compiled_rhs: bool):
    states = peers.dop853_runner(peers.course_of(scene), tmp_path, compiled_rhs)(1e-9).states
    assert np.max(np.abs(states - truth.states)) < 1e-7


@needs_peers
@pytest.mark.parametrize("solver", ["DOP853", "Radau"])
def test_scipy_reaches_the_reference(scene: Scene, truth: Truth, solver: str):
    states = peers.scipy_runner(peers.course_of(scene), solver)(1e-7).states
    assert np.max(np.abs(states - truth.states)) < 1e-5


@needs_peers
def test_a_course_holds_the_scenes_voltages(scene: Scene):
    course = peers.course_of(scene)
    assert course.durations_s.tolist() == pytest.approx([0.5] * 6)
    assert course.voltages_V[1].tolist() == [-2.0, 2.0, -1.0]
