"""Write an FMU of a scene's vehicle."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from laconic.base.outputs import check_ending, claim_file, is_special
from laconic.cli.options import OutputFile, SceneName, json_flag
from laconic.cli.streams import warn
from laconic.errors import BadInput
from laconic.fmu import make_fmu
from laconic.fmu.hinges import left_out
from laconic.fmu.ssp import make_ssp
from laconic.scene import read_scene
from laconic.scene.drives import DRIVE_PROTOCOLS
from laconic_fmu.network import TX_CLOCKS


@click.command("fmu")
@click.argument("scene", type=SceneName(hinges=True))
@click.option("--fmi", "version", type=click.Choice(("2", "3")), required=True, help="FMI 2.0 or 3.0.")
@click.option("--scalar", is_flag=True, help="FMI 3.0 without arrays, for importers that handle them badly.")
@click.option("--without-sources", is_flag=True, help="Binaries only: less than half the size.")
@click.option("--no-enumerations", is_flag=True, help="Whole numbers instead, for importers that know no enumerations.")
@click.option("--derivatives", is_flag=True,
              help="Co-Simulation only: partial derivatives are those of each step, by its start and its inputs.")
@click.option("--estimate", is_flag=True,
              help="Co-Simulation only: outputs estimate how far the run is from the exact solution.")
@click.option("--ssp", is_flag=True, help="An SSP archive (--fmi 2): the vehicle with a wheel-speed controller.")
@click.option("--bus", type=click.Choice(("can",)),
              help="The vehicle's CAN node as a network FMU by FMI-LS-BUS (--fmi 3), instead of its plain variables.")
@click.option("--drives", type=click.Choice(DRIVE_PROTOCOLS),
              help="With --bus: motor drives that play from the start; else the node speaks its own frames.")
@click.option("--tx-clock", type=click.Choice(TX_CLOCKS),
              help=f"With --bus: how it announces its frames.  [default: {TX_CLOCKS[0]}]")
@click.option("-o", "--out", type=OutputFile(), metavar="F.fmu",
              help="File to write; SCENE_fmi3.fmu if not given.")
@json_flag()
def command(scene: str, version: str, scalar: bool, without_sources: bool, no_enumerations: bool,
            derivatives: bool, estimate: bool, ssp: bool, out: Path | None, bus: str | None, drives: str | None,
            tx_clock: str | None, json_wanted: bool) -> None:
    """Writes an FMU whose start values are SCENE's vehicle, start, method and step.

    Model Exchange and Co-Simulation are both in it. In FMI 3.0 the number of wheels is a structural parameter; in
    FMI 2.0 and with --scalar it is a constant. With --derivatives or --estimate the FMU is for Co-Simulation alone, as
    is that of a vehicle with hinges on ground with friction.
    With --bus can it is the CAN node of SCENE, for co-simulation with other FMUs on a bus.
    """
    check_bus(version, bus, {"--scalar": scalar, "--ssp": ssp, "--no-enumerations": no_enumerations,
                               "--derivatives": derivatives, "--estimate": estimate},
              {"--drives": drives, "--tx-clock": tx_clock})
    if scalar and version == "2":
        raise BadInput("--scalar: FMI 2.0 has no arrays anyway; leave it out or use --fmi 3")
    if derivatives and ssp:
        raise BadInput("--derivatives: an SSP archive has no such variant; leave --ssp out")
    if estimate and (ssp or derivatives):
        other, name = ("ssp", "SSP archive") if ssp else ("derivatives", "FMU with --derivatives")
        raise BadInput(f"--estimate: an {name} has no such variant; leave --{other} out")
    ending = "ssp" if ssp else "fmu"
    if out is not None:
        check_ending("--out", out, (f".{ending}",))
    given = read_scene(scene)
    if out is None:
        kind = ("_scalar" if scalar else f"_{bus}" if bus else "") + ("_derivatives" if derivatives else "")
        kind += "_estimate" if estimate else ""
        out = claim_file("--out", Path(f"{given.path.stem}_fmi{version}{kind}.{ending}"))
    options: dict[str, Any] = {"version": int(version), "sources": not without_sources,
                               "enumerations": not no_enumerations}
    if bus:
        from laconic.fmu.network import make_network_fmu  # needs the extra `rig`, which other FMUs do not

        made = make_network_fmu(given, out, drives=drives, tx_clock=tx_clock or TX_CLOCKS[0],
                                sources=not without_sources)
    else:
        made = make_ssp(given, out, **options) if ssp else make_fmu(
            given, out, scalar=scalar, derivatives=derivatives, estimate=estimate, **options)
    size = None if is_special(made) else made.stat().st_size
    if json_wanted:
        click.echo(json.dumps({"scene": str(given.path), "fmi": int(version), "scalar": scalar,
                               "enumerations": not no_enumerations, "derivatives": derivatives, "estimate": estimate,
                               "bus": bus, "drives": drives, "real": "double",
                               "scene_real": given.run.real, "file": str(made), "bytes": size}, indent=1))
    else:
        shown = "" if size is None else f" ({size / 1000:.0f} kB)"
        click.echo(f"wrote {made}{shown}: {given.name}, {given.wheel_count} wheels")
    if line := left_out(given):
        warn(line)
    if given.run.real != "double":
        warn(f'{given.path}: run.real: is "{given.run.real}", but FMUs compute in double precision')


def check_bus(version: str, bus: str | None, others: dict[str, bool], needing: dict[str, str | None]) -> None:
    """BadInput for options that do not go with --bus, or not without it."""
    if bus is None:
        for name, value in needing.items():
            if value is not None:
                raise BadInput(f"{name} {value}: is for a network FMU; give --bus can, or leave it out")
        return
    if version != "3":
        raise BadInput(f"--bus {bus}: FMI {version}.0 has neither clocks nor binary variables; use --fmi 3")
    for name, is_given in others.items():
        if is_given:
            raise BadInput(f"{name}: a network FMU has no such variant; leave it out")
