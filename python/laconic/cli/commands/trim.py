"""Write the C that builds the core for one scene alone."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from laconic.cli.options import OutputFolder, SceneName
from laconic.core import REALS
from laconic.scene import read_scene
from laconic.tools.trim import trimmed


@click.command("trim")
@click.argument("scene", type=SceneName(hinges=True))
@click.option("--real", type=click.Choice(REALS), help="Scalar type; the scene's own where none is given.")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", default=Path(), show_default=True,
              help="Folder for the files.")
def command(scene: str, real: str | None, out: Path) -> None:
    """Writes the C files that make a build of the core for SCENE alone.

    laconic_scene.h holds the constants that leave out what the scene does without: compile the core, such as the two
    files of `laconic core`, with LACONIC_SCENE_HEADER naming it. laconic_scene_model.c holds the prepared model.
    `cmake -DLACONIC_SCENE=…` does all of this by itself.
    """
    read = read_scene(scene)
    chosen = real or read.run.real
    files = trimmed(read, chosen)
    files.write(out)
    words = {"damping": "decay of ideal rolling"} if files.needs.friction else {}  # the friction step keeps the motors'
    left_out = ", ".join(words.get(name, name.replace("_", " "))
                         for name, needed in asdict(files.needs).items() if not needed)
    click.echo(f"wrote {out / 'laconic_scene.h'}, laconic_scene_model.h, laconic_scene_model.c: "
               f"{chosen}, {files.method}, left out: {left_out or 'nothing'}")
