"""Long runs beside independent references, or in places where faults were found.

    long [NAME …] [--minutes M] [--seed S]

Each runs M minutes, or as long as its least piece of work takes."""

from __future__ import annotations

import argparse
import importlib

from assurance.common import Clock, Unusable

RUNS = {
    "batch": "lanes of made-up vehicles have the bits of the same vehicles alone, in every width of registers",
    "derivatives": "tangents of steps beside differences in 50 digits, adjoints beside Jacobians",
    "drift": "many steps of motions with a closed form: heading and place drift by rounding alone",
    "enclosures": "all scenes and random stiff vehicles enclosed: how wide, how far the core is",
    "fmu": "thousands of life cycles of FMU instances: constant memory; eight threads without races",
    "friction": "the friction solver beside a conic one in 40 digits, and vehicles that nothing drives",
    "identify": "made-up robots: the intervals of identify hold the true parameters in 93 to 97 % of all cases",
    "node": "one node process: lockstep with the core's bits, free runs at 1 kHz, constant memory",
    "play": "canopen, odrive-can and a C620 client drive a played vehicle, whose wheels have the core's bits",
    "rig": "all scenes in lockstep on the virtual bus and over SLCAN: the core's bits",
    "soft_double": "soft_double.c beside this processor's addition",
    "sweep": "sweeps killed at random instants have the bytes of undisturbed ones",
}
MODULES = {"derivatives": "core", "soft_double": "core", "node": "can", "play": "can", "rig": "can",
           "identify": "studies", "sweep": "studies"}
"""Of runs that have none of their own name."""


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="NAME", help="all by default: " + ", ".join(RUNS))
    parser.add_argument("--minutes", type=float, default=2.0, help="for each, 2 by default")
    parser.add_argument("--seed", type=int, default=1)


def run(options: argparse.Namespace) -> bool:
    """Prints what each found; the lines that it returns are what must not be."""
    if unknown := set(options.names) - RUNS.keys():
        raise Unusable(f"{sorted(unknown)[0]}: is no long run; known are {', '.join(RUNS)}")
    sound = True
    for name in options.names or RUNS:
        print(f"{name}: {RUNS[name]}", flush=True)
        module = importlib.import_module(f"assurance.long.{MODULES.get(name, name)}")
        bad = getattr(module, f"run_{name}")(Clock(options.minutes), options.seed)
        print(*(f"  WRONG: {line}" for line in bad[:20]), f"  {'FAILED' if bad else 'passed'}", sep="\n", flush=True)
        sound &= not bad
    return sound
