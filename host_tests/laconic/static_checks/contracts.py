"""Contracts in the sources (comments that begin with /*@, in ACSL), proved by Frama-C's WP for every input that they
allow: what a function may change, what holds where it accepts, what stays where it refuses.

WP leaves signed overflow of shifts to the analyser (`frama_c.py`), as `without` says; memory it checks itself."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass

from laconic.errors import BadInput
from laconic.static_checks.frama_c import CORE, NODE, Program, preprocessed, run_frama_c

COUNT = re.compile(r"^\[wp\] Proved goals: +(\d+) / (\d+)", re.MULTILINE)
OPEN = re.compile(r"^\[wp\] \[(?:Failed|Timeout|Unknown)\] Goal (\w+)", re.MULTILINE)
CONTRACT = re.compile(r"/\*@(?P<text>[^*]*(?:\*(?!/)[^*]*)*)\*/\s*\n(?P<code>[^\n]*(?:\n[^\n;{]*)?)")
NAME = re.compile(r"(\w+)\(")
PROVERS = ("-wp-prover", "z3,cvc4", "-wp-timeout", "10", "-wp-par", "1", "-wp-cache", "none",
           "-wp-auto", "wp:split,wp:range", "-warn-special-float", "none", "-no-unicode")


@dataclass(frozen=True)
class Room:
    """Functions of a part that are proved together. `inlined`: what they call that has no contract of its own. Without
    `memory` accesses and conversions are left to the analyser, which follows these functions, too."""

    name: str
    program: Program
    files: tuple[str, ...]
    functions: tuple[str, ...]
    inlined: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    memory: bool = True


@dataclass(frozen=True)
class Goals:
    """How many there were, and the names of those that no prover closed."""

    count: int
    open: list[str]


SHIFTS = ("-no-warn-signed-overflow",)
ROOMS = (
    Room("checksums", NODE, ("firmware_stub/src/crc.c", "firmware_stub/src/e2e.c"),
         ("laconic_crc8", "laconic_crc16", "laconic_crc32", "p22_crc", "p05_crc", "accept", "stray",
          "laconic_e2e_p22_protect", "laconic_e2e_p22_crc_is_right", "laconic_e2e_p05_protect",
          "laconic_e2e_p05_crc_is_right", "laconic_e2e_check"), without=SHIFTS),
    Room("slcan", NODE, ("firmware_stub/src/slcan.c",),
         ("length_of", "digit", "number", "laconic_slcan_init", "kind_of", "parse_frame"), without=SHIFTS),
    Room("words", NODE, ("firmware_stub/src/node_session.c",), ("word16", "word32", "put16", "put32", "count"),
         without=SHIFTS),
    Room("inputs", CORE, ("core_c/src/step.c",), ("is_finite", "refuse", "check_many", "laconic_input_check"),
         inlined=("magnitude",)),
    Room("starts", CORE, ("core_c/src/state.c",), ("check_start",), inlined=("magnitude",)),
    Room("states", CORE, ("core_c/src/state.c",),
         ("moves_in_range", "check_allowed", "find_state", "laconic_state_set"),
         inlined=("magnitude", "square", "dot", "vec", "zeta_of", "zeta_of_nu", "size", "set_zeta", "sum_of",
                  "vector_of", "scaled", "plus", "times", "rotated_twice", "inverse_row", "heading_advance"),
         memory=False),
    Room("encoders", CORE, ("core_c/src/encoder.c",),
         ("laconic_encoder_place", "laconic_encoder_turns", "laconic_encoder_shown")),
    Room("schedules", CORE, ("core_c/src/record.c",), ("stretch_at",)),
    Room("steps", CORE, ("core_c/src/integrator.c",), ("laconic_steps_in",), inlined=("magnitude",)),
)


def prove_contracts(room: Room, limit_s: float = 3600.0) -> Goals:
    """One room; BadInput where Frama-C or a prover is not there, or where it does not end well."""
    for tool in ("frama-c", "why3", "z3", "cvc4"):
        if shutil.which(tool) is None:
            raise BadInput(f"soak proof: there is no {tool}; install frama-c-base, why3, z3 and cvc4 (Debian), "
                           "then call `why3 config detect`")
    command = ["frama-c", *preprocessed(room.program), *room.files, *options_of(room)]
    return goals_of(room.name, run_frama_c(room.name, command, limit_s).stdout)


def options_of(room: Room) -> list[str]:
    """Of WP for one room."""
    inlined = ("-inline-calls", ",".join(room.inlined)) if room.inlined else ()
    memory = ("-wp-rte",) if room.memory else ()
    return [*inlined, *room.without, "-wp", *memory, "-wp-fct", ",".join(room.functions), *PROVERS]


def goals_of(name: str, printed: str) -> Goals:
    """What WP printed."""
    count = COUNT.search(printed)
    if count is None:
        raise BadInput(f"soak proof: {name}: WP did not end well: {printed[-300:]}")
    missing = int(count[2]) - int(count[1])
    found = sorted(set(OPEN.findall(printed)))
    return Goals(int(count[2]), found + [f"{name}: not named by WP"] * (missing - len(found)))


def contracts_in(text: str) -> list[str]:
    """The functions of a C text that have a contract; loop annotations and assertions are none."""
    found = []
    for match in CONTRACT.finditer(text):
        name = NAME.search(match["code"])
        if name is not None and re.match(r"\s*(requires|assigns|ensures)", match["text"]):
            found.append(name[1])
    return found
