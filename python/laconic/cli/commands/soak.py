"""Long fuzz, fault and endurance runs."""

from __future__ import annotations

import importlib
import json
import pkgutil
import random
from types import ModuleType
from typing import Any

import click
from rich.console import Console

import laconic.soak
from laconic.base.progress import progress_bar
from laconic.cli.options import InputPath, OutputFolder, json_flag
from laconic.errors import BadInput, nearest_of


def kinds() -> dict[str, str]:
    """Name on the command line → module."""
    found = (module.name for module in pkgutil.iter_modules(laconic.soak.__path__) if not module.name.startswith("_"))
    return {name.replace("_", "-"): name for name in found}


@click.command("soak")
@click.argument("what")
@click.option("--minutes", type=float, default=10.0, show_default=True, metavar="N", help="How long.")
@click.option("--seed", type=int, help="Seed of the random numbers; printed when not given.")
@click.option("--protocol", metavar="P", help="controllers, drive-frames: this one alone.")
@click.option("--board", metavar="B", help="controllers: virtual, process, emulated, or a board of rig; lateness.")
@click.option("--cycles", type=click.IntRange(min=1), metavar="N", help="controllers: 10000; fmu-cycles: 100000.")
@click.option("--seconds", type=float, metavar="S", help="lateness: on each board, 10 by default.")
@click.option("--hours", type=float, metavar="H", help="node: 24 by default.")
@click.option("--step", "step_s", type=float, metavar="S", help="controllers: period of the drives, 0.005 by default.")
@click.option("--vehicles", type=click.IntRange(min=1), metavar="N", help="population: 2000 by default.")
@click.option("--method", metavar="METHOD", help="population: beside auto, or A,B; long: instead of auto and rk4.")
@click.option("--real", metavar="REAL", help="population: double, unless single.")
@click.option("--steps", type=click.IntRange(min=1), metavar="N", help="long: 10⁹ by default.")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", help="population, long: what is done; goes on there.")
@click.option("--sample", type=click.IntRange(min=1), metavar="N", help="mutants, faults of memory: so many.")
@click.option("--survivors", type=click.IntRange(min=0), metavar="N", help="mutants: passed with so many, or 0.")
@click.option("--faults", type=InputPath(), metavar="FILE",
              help="mutants: asks the list of equivalents alone, about another sampler's faults, a line of JSON each.")
@click.option("--only", metavar="PART",
              help="mutants: core, node, drives, commands, fmu or a C file; faults: a kind; fuzz, proof: one of them.")
@click.option("--minimise", is_flag=True, default=None, help="fuzz: afterwards the kept corpora of the sources.")
@json_flag()
def command(what: str, minutes: float, seed: int | None, json_wanted: bool, **special: Any) -> int:
    """Runs WHAT for a long time and reports what was found.

    \b
    batch            lanes of made-up vehicles beside the same alone, bit for bit, in every
                     width of registers, every method and both scalar types
    boards           emulated boards started anew, idle and with all cores busy
    controllers      PyPI's canopen and odrive-can and a C620 client drive vehicles on the
                     process and an emulated board: wheels move as the core does with
                     the drives' torques, bit for bit; ends after --cycles
    derivatives      tangents of a thousand steps of each method against differences in
                     50 digits, adjoints against Jacobians; half an hour
    drive-frames     frames of each protocol of drives with faults between, N minutes
                     each, under libFuzzer; Ctrl-C keeps and prints what was found
    enclosures       all scenes over their whole run and random vehicles, stiff ones too,
                     enclosed: how wide, how far the core is
    faults           clocks that run wrong, power lost between any two frames, each bit of
                     the node's memory flipped (goes on where it was ended), and the fault
                     matrix of the rig with new seeds; --only clocks, power, memory, frames
    fmu              random use of the FMUs' C interface, under sanitizers
    fmu-cycles       100,000 life cycles of FMU instances, memory constant
    friction         the friction solver against a conic one with 40 digits, and driven
                     motions; Ctrl-C prints what was found until then
    friction-energy  whole vehicles that nothing drives: energy never grows, rest holds;
                     a minute takes millions of steps
    free-run         the node process at 1 kHz: no step may be lost
    fuzz             what reads frames (SLCAN, node, loader, protocols of drives), vehicles,
                     steps, FMI calls and saved states under libFuzzer, N minutes each;
                     rates are kept in build/fuzz/results.json
    identify         a thousand made-up robots: what their intervals hold
    lateness         play at 1 kHz with four drives, in this process and in the node's,
                     for a controller in another process: how late periods begin
    long             10⁹ steps of motions with a closed form: drift of heading and place;
                     goes on where it was ended
    mutants          the C sources with one small fault each: some C test must notice it;
                     goes on where the last run ended, and prints by file what survived
    node             one node process for 24 hours: lockstep with the core's bits, free runs
                     at 1 kHz, its memory constant and its checks of it silent
    population       2000 made-up vehicles, damping up to a million times the usual,
                     beside their true motion: errors' quantiles, error estimates beside
                     them, refusals, the worst as scenes; goes on where it was ended
    misra            MISRA C:2012 by cppcheck's addon against the stated deviations, and
                     clang-tidy, over core, node and FMUs; takes minutes
    proof            Frama-C's analyser over public functions of core and node: no undefined
                     behaviour for any input in the stated boxes; WP for contracts; an hour,
                     and only what has other sources than at its last run
    rig              all scenes in lockstep on the virtual bus, same bits
    slcan            all scenes over SLCAN to a node process
    soft-double      soft_double.c beside this processor's addition; a minute takes 10⁹ pairs
    sweep            sweeps killed at random instants, their bytes against undisturbed ones
    targets          one hash of all trajectories on every target that compilers and
                     emulators here reach; takes as long as it takes

    Exit status 1 when something was found that must not be.
    """
    modules = kinds()
    if what not in modules:
        raise BadInput(f"soak: there is no {what}; {nearest_of(what, modules)}")
    if not 0.0 < minutes < float("inf"):
        raise BadInput(f"--minutes: {minutes:g} is not usable; give a finite number above zero")
    module = importlib.import_module(f"laconic.soak.{modules[what]}")
    usual = getattr(module, "SEED", None) or random.SystemRandom().randrange(2**31)
    chosen = usual if seed is None else seed
    more = own_options(what, module, special)
    length = module.length(**more) if hasattr(module, "length") else None
    by_time = {"minutes": minutes, "seed": chosen} if length is None else {}
    stopped: BaseException | None = None
    try:
        with progress_bar(f"soak {what}", 60.0 * minutes if length is None else length) as advance:
            result = module.soak(minutes, chosen, advance, **more)
    except laconic.soak.StoppedEarly as early:
        result, stopped = {"stopped": "early, so this is what was found until then", **early.result}, early.__cause__
    _show({"what": what, **by_time, **result}, json_wanted)
    if stopped is not None:
        raise stopped
    return 0 if result["passed"] else 1


def own_options(what: str, module: ModuleType, given: dict[str, Any]) -> dict[str, Any]:
    """Options that some modules alone have, of those that were given; BadInput for those that this one has not."""
    found = {name: value for name, value in given.items() if value is not None}
    for name, value in found.items():
        if name not in getattr(module, "OPTIONS", ()):
            raise BadInput(f"--{name.removesuffix('_s')} {value}: has no effect on soak {what}; leave it out")
    return found


def _show(result: dict[str, Any], json_wanted: bool) -> None:
    if json_wanted:
        click.echo(json.dumps(result, indent=1))
        return
    console = Console()
    for name, value in result.items():
        lines = value if isinstance(value, list) and all(isinstance(each, str) for each in value) else [value]
        for line in lines or ["none"]:
            console.print(f"{name:>24}  {line}", markup=False, soft_wrap=True)
            name = ""
