"""Find why odometry and the true path part: radius, distance, tracker, lag or slip."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.base.outputs import write_text
from laconic.cli.options import InputPath, OutputFile, OutputFolder, SceneName, json_flag
from laconic.cli.options_of_logs import map_option
from laconic.errors import BadInput

EXPORTS = (".yaml", ".yml", ".h", ".toml")


@click.command("audit")
@click.argument("logs", type=InputPath(), nargs=-1, required=True, metavar="LOG...")
@click.argument("scene", type=SceneName(hinges=True))
@map_option
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", help="Write audit.md, audit.json and a picture there.")
@click.option("--export", "exports", type=OutputFile(*EXPORTS), multiple=True, metavar="FILE",
              help="Write the result: .yaml for ros2_controllers, .h for firmware, .toml as a scene.")
@click.option("--map-out", type=OutputFile(".toml", stdout=False), metavar="FITTED_MAP.toml",
              help="With steered wheels: write the map with its identified values (steering, lag, tracker). "
              "Needs --map.")
@json_flag("Machine-readable result on stdout.")
def command(logs: tuple[Path, ...], scene: str, map_path: Path | None, out: Path | None, exports: tuple[Path, ...],
            map_out: Path | None, json_wanted: bool) -> None:
    """Compares the odometry of LOG..., recorded runs with a true pose, with SCENE, which comes last.

    Radius and distance of the wheels, gain and offset of steered ones, place of the tracker and the time lag between
    wheels and pose each get their share of the error; what none of them explains is slip, or noise (docs/bags.md).
    """
    from laconic.base.progress import progress_bar
    from laconic.robot.identify import audit_page
    from laconic.robot.identify.audit import STEPS, audit
    from laconic.robot.identify.audit_page import export
    from laconic.robot.identify.fitted_map import fitted_map_text
    from laconic.robot.logs import gather_logs
    from laconic.robot.logs.column_map import named_map
    from laconic.scene import read_scene

    given = read_scene(scene)
    if map_out is not None and (map_path is None or not given.has_hinges):
        raise BadInput("--map-out: needs --map, the map that it corrects" if map_path is None else
                       f"--map-out: {given.path} has no steered wheels; --export FITTED.toml holds all that is found")
    runs, _ = gather_logs(logs, map_path)
    with progress_bar("auditing", STEPS) as advance:
        found = audit(given, runs, advance)
    for path in exports:
        write_text(path, export(found, path))
    if out is not None:
        audit_page.draw(found, out / "audit.png")
        write_text(out / "audit.md", audit_page.as_text(found, "audit.png"))
        write_text(out / "audit.json", json.dumps(audit_page.as_numbers(found), indent=1) + "\n")
    click.echo(json.dumps(audit_page.as_numbers(found), indent=1) if json_wanted else audit_page.as_text(found))
    if map_out is not None and map_path is not None:  # last, as it may refuse: the rest is written by then
        write_text(map_out, fitted_map_text(found.study, named_map(map_path)))
