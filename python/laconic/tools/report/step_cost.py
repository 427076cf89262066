"""What an explicit step of fourth order costs on this machine: the whole core, the core trimmed to the scene, and a
kernel written by hand for this one vehicle, with the core's refusals and without any."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report.counting import cachegrind_present, host_instructions, host_state
from laconic.tools.report.speed import bench_contestant, race
from laconic.tools.report.workshop import HOST, Variant, Workshop

STEP_S, STEPS = 0.01, 20_000
HAND = {"by hand": True, "by hand, refuses nothing": False}
Row = dict[str, Any]


def rows(rounds: int) -> list[Row]:
    """Each with its time and instructions, over those of the whole core and of the kernel by hand; BadInput where
    there is no compiler."""
    if lacking := HOST.missing:
        raise BadInput(f"what: step needs {lacking}")
    with TemporaryDirectory() as folder:
        return rows_of(Workshop(Path(folder)), rounds)


def rows_of(shop: Workshop, rounds: int) -> list[Row]:
    """The same, built there."""
    best = race({who: bench_contestant(library, STEPS) for who, library in libraries(shop).items()}, rounds)
    built = programs(shop)
    counted = {who: host_instructions(program) for who, program in built.items()} if cachegrind_present() else {}
    bits = {who: host_state(program, STEPS) for who, program in built.items()}
    return [{"who": who, "real": "double", "instructions": round(counted[who], 1) if counted else None,
             "ns_per_step": seconds / STEPS * 1e9, "over_whole": seconds / best["whole core"],
             "over_hand": seconds / best["by hand"], "same_bits": "yes" if bits[who] == bits["whole core"] else "NO"}
            for who, seconds in best.items()]


def variant(*, trim: bool) -> Variant:
    """Scene s1 in double."""
    return Variant(read_scene("s1").with_run(method=EXPLICIT, step_s=STEP_S), "double", trim=trim)


def programs(shop: Workshop) -> dict[str, Path]:
    """Counting programs, by what they are."""
    return {"whole core": shop.host_program(variant(trim=False)), "trimmed core": shop.host_program(variant(trim=True)),
            **{who: shop.hand_program(variant(trim=True), refuses=refuses) for who, refuses in HAND.items()}}


def libraries(shop: Workshop) -> dict[str, Path]:
    """The same to be timed."""
    return {"whole core": shop.host_library(variant(trim=False)), "trimmed core": shop.host_library(variant(trim=True)),
            **{who: shop.hand_library(variant(trim=True), refuses=refuses) for who, refuses in HAND.items()}}
