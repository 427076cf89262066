"""Show what is in a recorded log, and guess its map."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from laconic.base.outputs import is_stdout, write_text
from laconic.cli.options import InputPath, OutputFile, SceneName, json_flag


@click.command("logs")
@click.argument("log", type=InputPath(), metavar="LOG")
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), metavar="MAP.toml",
              help="Write the guessed map; - for stdout.")
@click.option("--scene", type=SceneName(hinges=True),
              help="The robot whose wheels the names of columns or joints are of.")
@click.option("--fields", "topic", metavar="TOPIC",
              help="Show the fields of one topic: count, first, smallest and largest value, probable unit.")
@json_flag("Machine-readable result on stdout.")
def command(log: Path, out: Path | None, scene: str | None, topic: str | None, json_wanted: bool) -> None:
    """Shows what is in LOG: a CSV or other text, a MATLAB file, a CAN log, or a recording of topics (rosbag1, rosbag2,
    MCAP, ULog).

    Columns or topics are listed with what they probably are. MAP.toml is a map to begin with, for --map of replay,
    identify and audit; what it lacks is printed, and written into it as comments.
    """
    from laconic.robot.logs.fields import fields_of
    from laconic.robot.logs.inspection import inspect

    if topic is not None:
        fields = fields_of(log, topic)
        click.echo(json.dumps(fields.as_json(), indent=1) if json_wanted else "\n".join(fields.lines()))
        return
    found = inspect(log, _wheels(scene))
    if out is not None:
        write_text(out, found.map_text())
    if json_wanted:
        click.echo(json.dumps(found.as_json(), indent=1))
    else:
        for line in found.lines(out):
            click.echo(line, err=out is not None and is_stdout(out))


def _wheels(scene: str | None) -> list[dict[str, Any]] | None:
    if scene is None:
        return None
    from laconic.scene import read_scene

    wheels: list[dict[str, Any]] = read_scene(scene).vehicle["wheel"]
    return wheels
