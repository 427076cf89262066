"""Find why odometry and the true path part: radius, distance, tracker, lag or slip."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.base.outputs import write_text
from laconic.cli.options import InputPath, OutputFile, OutputFolder, SceneName, json_flag
from laconic.cli.options_of_logs import map_option

EXPORTS = (".yaml", ".yml", ".h", ".toml")


@click.command("audit")
@click.argument("logs", type=InputPath(), nargs=-1, required=True, metavar="LOG...")
@click.argument("scene", type=SceneName(hinges=True))
@map_option
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", help="Write audit.md, audit.json and a picture there.")
@click.option("--export", "exports", type=OutputFile(*EXPORTS), multiple=True, metavar="FILE",
              help="Write what was found: .yaml for ros2_controllers, .h for firmware, .toml as a scene.")
@json_flag("Machine-readable result on stdout.")
def command(logs: tuple[Path, ...], scene: str, map_path: Path | None, out: Path | None, exports: tuple[Path, ...],
            json_wanted: bool) -> None:
    """Compares the odometry of LOG..., recorded runs with a true pose, with SCENE, which comes last.

    Radius and distance of the wheels, gain and offset of steered ones, place of the tracker and the time lag between
    wheels and pose each get their share of the error; what none of them explains is slip, or noise (docs/bags.md).
    """
    from laconic.base.progress import progress_bar
    from laconic.robot.identify import audit_page
    from laconic.robot.identify.audit import STEPS, audit
    from laconic.robot.identify.audit_page import export
    from laconic.robot.logs import gather_logs
    from laconic.scene import read_scene

    given = read_scene(scene)
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
