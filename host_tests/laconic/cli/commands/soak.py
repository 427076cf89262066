"""Long fuzz, fault and endurance runs."""

from __future__ import annotations

import importlib
import json
import pkgutil
import random
from typing import Any

import click
from rich.console import Console

import laconic.soak
from laconic.cli.options import json_flag
from laconic.errors import BadInput, nearest_of
from laconic.progress import progress_bar


def kinds() -> dict[str, str]:
    """Name on the command line → module."""
    found = (module.name for module in pkgutil.iter_modules(laconic.soak.__path__) if not module.name.startswith("_"))
    return {name.replace("_", "-"): name for name in found}


@click.command("soak")
@click.argument("what")
@click.option("--minutes", type=float, default=10.0, show_default=True, metavar="N", help="How long.")
@click.option("--seed", type=int, help="Seed of the random numbers; printed when not given.")
@click.option("--protocol", metavar="P", help="drive-frames: this one alone.")
@json_flag()
def command(what: str, minutes: float, seed: int | None, protocol: str | None, json_wanted: bool) -> int:
    """Runs WHAT for a long time and reports what was found.

    \b
    boards           emulated boards started anew, idle and with all cores busy
    drive-frames     frames of each protocol of drives with faults between, N minutes
                     each, under libFuzzer; Ctrl-C keeps and prints what was found
    faults           the fault matrix of the rig, with new seeds
    fmu              random use of the FMUs' C interface, under sanitizers
    friction         the friction solver against a conic one with 40 digits, and driven
                     motions; Ctrl-C prints what was found until then
    friction-energy  whole vehicles that nothing drives: energy never grows, rest holds;
                     a minute takes millions of steps
    free-run         the node process at 1 kHz: no step may be lost
    fuzz             what reads frames (SLCAN, node, loader, protocols of drives) under libFuzzer
    identify         a thousand made-up robots: what their intervals hold
    rig              all scenes in lockstep on the virtual bus, same bits
    slcan            all scenes over SLCAN to a node process

    Exit status 1 when something was found that must not be.
    """
    modules = kinds()
    if what not in modules:
        raise BadInput(f"soak: there is no {what}; {nearest_of(what, modules)}")
    if not 0.0 < minutes < float("inf"):
        raise BadInput(f"--minutes: {minutes:g} is not usable; give a finite number above zero")
    if protocol is not None and what != "drive-frames":
        raise BadInput(f"--protocol {protocol}: is of soak drive-frames; leave it out")
    chosen = random.SystemRandom().randrange(2**31) if seed is None else seed
    module = importlib.import_module(f"laconic.soak.{modules[what]}")
    more = {} if protocol is None else {"protocol": protocol}
    stopped: BaseException | None = None
    try:
        with progress_bar(f"soak {what}", 60.0 * minutes) as advance:
            result = module.soak(minutes, chosen, advance, **more)
    except laconic.soak.StoppedEarly as early:
        result, stopped = {"stopped": "early, so this is what was found until then", **early.result}, early.__cause__
    _show({"what": what, "minutes": minutes, "seed": chosen, **result}, json_wanted)
    if stopped is not None:
        raise stopped
    return 0 if result["passed"] else 1


def _show(result: dict[str, Any], json_wanted: bool) -> None:
    if json_wanted:
        click.echo(json.dumps(result, indent=1))
        return
    console = Console()
    for name, value in result.items():
        console.print(f"{name:>24}  {value}")
