"""Sizes and instructions: every method on the boards, and every scene whole and trimmed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from laconic.base.paths import sources_missing
from laconic.core import load
from laconic.errors import Refused
from laconic.scene import METHODS, Scene
from laconic.tools.report.counting import (
    cachegrind_present,
    count_on_board,
    host_state,
    size_of_step,
)
from laconic.tools.report.workshop import BOARDS, HOST, M4F, Target, Variant, Workshop


def missing_tools() -> list[str]:
    """What is not installed of what boards and counts need."""
    if missing := sources_missing():
        return [missing]
    found = [] if all(board.present for board in BOARDS) else ["arm-none-eabi-gcc and qemu-system-arm"]
    found += [] if HOST.present else ["gcc"]
    return found if cachegrind_present() else [*found, "valgrind"]


def board_row(workshop: Workshop, target: Target, variant: Variant) -> dict[str, Any]:
    """One line of the tables; also whether the board's bits are the host's."""
    run = variant.scene.run
    row: dict[str, Any] = {"scene": variant.scene.path.stem, "method": run.method, "real": variant.real,
                           "processor": target.name, "optimisation": variant.optimisation,
                           "build": "trimmed" if variant.trim else "whole"}
    try:
        _, files = workshop.files(variant)
    except Refused as refused:
        return row | {"status": refused.status}
    size, ran = size_of_step(workshop, target, variant), count_on_board(workshop, target, variant)
    if ran.status:
        core = load(variant.real)
        return row | {"status": core.text(core.lib.laconic_status_name(ran.status))}
    host = host_state(workshop.host_program(variant), ran.steps)
    row |= {"status": "ok", "chosen": files.method, "instructions": round(ran.instructions, 1),
            "stack_measured": ran.stack_bytes} | asdict(size)
    return row | {"double_helpers": len(size.double_helpers), "heap": len(size.heap), "same_bits": host == ran.state}


def method_rows(workshop: Workshop, scene: Scene, reals: Sequence[str], boards: Sequence[Target] = BOARDS,
                methods: Sequence[str] = METHODS[1:], advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Every method on every board, whole; on the Cortex-M4F also trimmed and at -Os."""
    rows = []
    for board in boards:
        kinds = [("-O2", False), ("-Os", False), ("-O2", True), ("-Os", True)] if board is M4F else [("-O2", False)]
        for real in reals:
            for method in methods:
                for optimisation, trim in kinds:
                    variant = Variant(scene.with_run(method=method), real, optimisation, trim)
                    rows.append(board_row(workshop, board, variant))
                advance()
    return rows


def scene_rows(workshop: Workshop, scenes: Sequence[Scene], reals: Sequence[str], board: Target = M4F,
               advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Every scene by its own method, whole and trimmed side by side."""
    rows = []
    for scene in scenes:
        for real in reals:
            rows += [board_row(workshop, board, Variant(scene, real, "-Os", trim)) for trim in (False, True)]
            advance()
    return rows
