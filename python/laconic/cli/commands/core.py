"""Write the C core as two files, for programs and firmware."""

from __future__ import annotations

from pathlib import Path

import click

from laconic.base.outputs import write_text
from laconic.base.paths import SOURCE_DIR, built
from laconic.cli.options import OutputFolder

FILES = ("laconic.h", "laconic.c")
SOFT_DOUBLE = ("soft_double.h", "soft_double.c", "check_double.c")


@click.command("core")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR", default=Path("laconic"), show_default=True,
              help="Folder for the two files.")
@click.option("--soft-double", is_flag=True,
              help="Also the addition in double for Arm processors without it, such as Cortex-M3 and M4, and a program "
                   "that checks whether it is needed.")
def command(out: Path, soft_double: bool) -> None:
    """Writes the C core as laconic.h and laconic.c.

    A C compiler needs nothing else: `cc -O2 -I. program.c laconic/laconic.c -o program` for a program that has
    `#include <laconic/laconic.h>`. The header is the manual. With the files of `laconic trim` it is the core for one
    scene alone.
    """
    sources = [built(f"amalgamation/{name}") for name in FILES]
    if soft_double:
        sources += [SOURCE_DIR / "core_c" / "optional" / "soft_double" / name for name in SOFT_DOUBLE]
    for path in sources:
        write_text(out / path.name, path.read_text(encoding="utf-8"))
    click.echo(f"wrote {', '.join(str(out / path.name) for path in sources)}")
