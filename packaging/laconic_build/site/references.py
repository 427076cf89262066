"""References of the site that are made from the product: commands, Python names, FMUs."""

from __future__ import annotations

import inspect
from pathlib import Path
from xml.etree import ElementTree

import click

import laconic
from laconic.cli.main import commands

# ---- Every command with its help, as the command line prints it.

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


# ---- The Python interface: `laconic.__all__`, by its docstrings.

def python_page() -> str:
    """Directives for Sphinx's autodoc, in the order of `laconic.__all__`."""
    parts = ["# Python reference", "The public interface, `laconic.__all__`. [From Python](python.md) shows it at "
                                   "work."]
    for name in laconic.__all__:
        value = getattr(laconic, name)
        if isinstance(value, tuple):
            parts.append(f"## {name}\n\n" + ", ".join(f"`{each}`" for each in value))
            continue
        kind = "autoexception" if inspect.isclass(value) and issubclass(value, Exception) else \
            "autoclass" if inspect.isclass(value) else "autofunction"
        members = "\n   :members:" if kind in ("autoclass", "autoexception") else ""
        parts.append(f"## {name}\n\n```{{eval-rst}}\n.. {kind}:: laconic.{name}{members}\n```")
    return "\n\n".join(parts) + "\n"


# ---- The variables of the FMUs, from their descriptions.

DESCRIPTIONS = {"Rigid vehicles": "modelDescription.xml",
                "Vehicles with hinges": "fmu/articulated/modelDescription.xml"}
HEAD = "| variable | unit or type | start | description |\n| --- | --- | --- | --- |"


def fmi_page(source: Path) -> str:
    """A table for each causality of each description."""
    parts = ["# FMI variables", "FMI 2 has each element of an array as a variable of its own, counted from 1."]
    for title, name in DESCRIPTIONS.items():
        parts += [f"## {title}", f"Made from `{name}`."]
        for causality, rows in _groups(source / name).items():
            parts += [f"### {causality}", "\n".join([HEAD, *rows])]
    return "\n\n".join(parts) + "\n"


def _groups(path: Path) -> dict[str, list[str]]:
    groups: dict[str, list[str]] = {}
    for variable in ElementTree.parse(path).getroot().iterfind(".//ModelVariables/*"):
        dimensions = "[]" * len(variable.findall("Dimension"))
        cells = [f"`{variable.get('name')}{dimensions}`", variable.get("unit") or variable.tag.removeprefix("fmi"),
                 variable.get("start") or "", (variable.get("description") or "").replace("|", "\\|")]
        groups.setdefault(variable.get("causality", "local"), []).append("| " + " | ".join(cells) + " |")
    return groups
