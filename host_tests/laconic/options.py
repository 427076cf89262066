"""Options of the command line that do not go together."""

from __future__ import annotations

from collections.abc import Mapping

import click
from click.core import ParameterSource

from laconic.errors import BadInput


def only_one(flags: Mapping[str, bool]) -> str | None:
    """The option that was given, if any; BadInput for two of them."""
    given = [flag for flag, is_given in flags.items() if is_given]
    if len(given) > 1:
        raise BadInput(f"{' '.join(given)}: exclude each other; give one of them")
    return given[0] if given else None


def belongs_to(flag: str, is_on: bool, *options: str) -> None:
    """BadInput for an option that was given although the flag that makes use of it is off."""
    context = click.get_current_context()
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name) is ParameterSource.COMMANDLINE
        if given and not is_on and parameter.opts[0] in options:
            raise BadInput(f"{parameter.opts[0]}: says something to {flag} alone; leave it out, or add {flag}")
