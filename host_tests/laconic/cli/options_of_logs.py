"""Options of the commands that read recorded logs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from laconic.cli.options import InputPath
from laconic.logs.column_map import named_map


class MapPath(InputPath):
    """A column map by its path, or by the name of one that comes with the project."""

    name = "map"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path of its file, noted as an input."""
        return super().convert(str(named_map(Path(value))) if str(value) else value, param, ctx)


map_option = click.option("--map", "map_path", type=MapPath(), metavar="MAP.toml",
                          help="Which column is what; a map that comes with the project recognises its logs by itself.")
