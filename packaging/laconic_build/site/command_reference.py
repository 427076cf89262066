"""Every command with its help, as the command line prints it."""

from __future__ import annotations

import click

from laconic.cli.main import commands


def command_page() -> str:
    """One page, a part for each command."""
    context = click.Context(commands, info_name="laconic")
    parts = ["# Commands", "As `laconic COMMAND --help` prints them.", f"```text\n{commands.get_help(context)}\n```"]
    for name in commands.list_commands(context):
        command = commands.get_command(context, name)
        assert command is not None
        inner = click.Context(command, info_name=f"laconic {name}", max_content_width=110, terminal_width=110)
        parts += [f"## laconic {name}", f"```text\n{command.get_help(inner)}\n```"]
    return "\n\n".join(parts) + "\n"
