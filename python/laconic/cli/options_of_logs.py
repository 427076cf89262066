"""Options of the commands that read recorded logs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from laconic.base.paths import exists
from laconic.cli.options import InputPath
from laconic.errors import BadInput, nearest_of
from laconic.robot.logs.column_map import map_names, named_map


class MapPath(InputPath):
    """A column map by its path, or by the name of one that comes with the project."""

    name = "map"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path of its file, noted as an input."""
        path = super().convert(str(named_map(Path(value))) if str(value) else value, param, ctx)
        if str(value) == path.name and not path.suffix and not exists(path):
            raise BadInput(f"--map {value}: cannot be read (no such file), and no map of the project has this name; "
                           f"{nearest_of(str(value), map_names())}")
        return path


class SeveralAfter(click.Command):
    """A command whose option --judge takes every word up to the next option, so that the shell's * may stand there."""

    several = "--judge"

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Names the option before each of its words."""
        spread, is_open = list[str](), False
        for word in args:
            if word.startswith("-") and word != "-":
                is_open = word == self.several
                spread += [] if is_open else [word]
            else:
                spread += [self.several, word] if is_open else [word]
        if args and args[-1] == self.several:
            spread.append(self.several)  # click says what is missing
        return super().parse_args(ctx, spread)


map_option = click.option("--map", "map_path", type=MapPath(), metavar="MAP.toml",
                          help="Which column is what; a map that comes with the project recognises its logs by itself.")
