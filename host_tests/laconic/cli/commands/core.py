"""Write the C core as two files, for programs and firmware."""

from __future__ import annotations

from pathlib import Path

import click

from laconic.cli.options import OutputFolder
from laconic.outputs import write_text
from laconic.paths import built

FILES = ("laconic.h", "laconic.c")


@click.command("core")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", default=Path("laconic"), show_default=True,
              help="Folder for the two files.")
def command(out: Path) -> None:
    """Writes the C core as laconic.h and laconic.c.

    A C compiler needs nothing else: `cc -O2 -I. program.c laconic/laconic.c -o program` for a program that has
    `#include <laconic/laconic.h>`. The header is the manual. With the files of `laconic trim` it is the core for one
    scene alone.
    """
    for name in FILES:
        write_text(out / name, built(f"amalgamation/{name}").read_text(encoding="utf-8"))
    click.echo(f"wrote {out / FILES[0]}, {out / FILES[1]}")
