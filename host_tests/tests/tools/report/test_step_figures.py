"""Instructions, stack and bytes of an explicit step stay where docs/performance.md has them: the same on every run."""

from __future__ import annotations

import pytest

from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report import step_cost
from laconic.tools.report.boards import board_row
from laconic.tools.report.counting import cachegrind_present, host_instructions
from laconic.tools.report.workshop import HOST, M4F, Target, Variant, Workshop

pytestmark = pytest.mark.nightly

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


def test_what_a_measurement_lacks_is_named_with_its_remedy(monkeypatch: pytest.MonkeyPatch):
    none = Target("none", "no-such-")
    assert none.missing == "no-such-gcc with its C library, which comes apart: install both" and not none.present
    assert Target("board", "no-such-", machine="none").missing.startswith(("qemu-system-arm: install", "no-such-gcc"))
    monkeypatch.setattr(step_cost, "HOST", none)
    with pytest.raises(BadInput, match=r"^what: step needs no-such-gcc with its C library, which comes apart: install"):
        step_cost.rows(1)


@needs_counter
@pytest.mark.parametrize(("real", "build"), list(HOST_MOST))
def test_instructions_of_a_step_on_the_host(workshop: Workshop, capsys: pytest.CaptureFixture[str], real: str,
                                            build: str):
    found = host_instructions(workshop.host_program(explicit(real, trim=build == "trimmed", step_s=0.01)))
    with capsys.disabled():
        print(f"\nrk4, {real}, {build}: {found:.1f} instructions a step")
    assert 400 < found < HOST_MOST[real, build]


@needs_counter
def test_a_trimmed_step_is_close_to_a_kernel_written_by_hand(workshop: Workshop, capsys: pytest.CaptureFixture[str]):
    rows = {row["who"]: row for row in step_cost.rows_of(workshop, rounds=1)}
    counts = {who: row["instructions"] for who, row in rows.items()}
    with capsys.disabled():
        print(f"\n{counts}")
    assert [row["same_bits"] for row in rows.values()] == ["yes"] * 4
    assert counts["trimmed core"] <= 1.1 * counts["by hand"]
    assert counts["by hand, refuses nothing"] < counts["by hand"]


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
