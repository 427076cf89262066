"""List the scenes that come with the project, or copy one to edit it."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.base.outputs import STDOUT, is_stdout, write_text
from laconic.base.paths import SCENE_DIR, scene_names
from laconic.cli.options import OutputFile, json_flag
from laconic.errors import BadInput, nearest_of
from laconic.scene.table import read_toml


@click.command("scenes")
@click.argument("name", required=False)
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), metavar="F.toml",
              help="Copy the scene to this new file; - or not given: stdout.")
@json_flag("The list as JSON.")
def command(name: str | None, out: Path | None, json_wanted: bool) -> None:
    """Lists the scenes that come with the project, or with NAME writes that one to edit it.

    `laconic scenes s1 -o my.toml` copies a scene with its comments; `laconic simulate my.toml` then runs the copy. A
    file that exists is not overwritten, because it may be a copy with your changes.
    """
    if name is None:
        if out is not None:
            raise BadInput(f"--out {out}: needs the name of one scene; give NAME, such as laconic scenes s1 -o my.toml")
        _list(json_wanted)
        return
    if json_wanted:
        raise BadInput("--json: is for the list of all scenes; leave out the name or --json")
    text = _text_of(name)
    target = STDOUT if out is None else out
    if not is_stdout(target) and target.is_file():
        raise BadInput(f"--out {target}: exists already and may hold your changes; choose another name, or delete it")
    write_text(target, text)
    if not is_stdout(target):
        click.echo(f"wrote {target}")


def _list(json_wanted: bool) -> None:
    titles = {name: read_toml(SCENE_DIR / f"{name}.toml").text("name", name) for name in scene_names()}
    if json_wanted:
        click.echo(json.dumps({"scenes": [{"scene": name, "name": title} for name, title in titles.items()]}))
        return
    width = max(map(len, titles))
    for name, title in titles.items():
        click.echo(f"{name:{width}}  {title}")


def _text_of(name: str) -> str:
    if name not in scene_names():
        raise BadInput(f"{name}: no scene of this name comes with the project; {nearest_of(name, scene_names())}")
    return (SCENE_DIR / f"{name}.toml").read_text(encoding="utf-8")
