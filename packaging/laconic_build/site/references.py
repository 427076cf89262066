"""References of the site that are made from the product: commands, Python names, FMUs.

The C interface from the public headers: each declaration under the comment that stands above it.
"""

from __future__ import annotations

import inspect
import re
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


HEADERS = ("laconic.h", "vehicle.h", "friction.h", "sensors.h", "batch.h", "derivatives.h", "filter.h", "estimate.h",
           "articulated.h", "articulated_friction.h", "status.h", "real.h")
SECTION = re.compile(r"/\* -{8,} (.+?) -+ \*/")
COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)


def c_page(source: Path) -> str:
    """One page, a part for each header."""
    parts = ["# C reference", "Made from the comments of `core_c/include/laconic`. Compile with the folder "
                              "`core_c/include` on the "
             "include path and `#include <laconic/laconic.h>`, which includes the others but "
             "`batch.h`, `derivatives.h`, `filter.h` and `estimate.h`."]
    for name in HEADERS:
        path = source / "core_c" / "include" / "laconic" / name
        if path.is_file():
            parts += [f"## {name}", *_blocks(path.read_text(encoding="utf-8"))]
    return "\n\n".join(parts) + "\n"


def _blocks(text: str) -> list[str]:
    """Paragraphs of the header: its head comment, sections, comments, declarations."""
    found: list[str] = []
    for block in re.split(r"\n\s*\n", text):
        block = block.strip("\n")
        if not block.strip() or _is_frame(block):
            continue
        if section := SECTION.match(block.strip()):
            found.append(f"### {section[1].strip().capitalize()}")
            block = block.strip()[section.end():].strip("\n")
            if not block.strip():
                continue
        found.append(f"```c\n{_without_frame(block)}\n```")
    return found


def _without_frame(block: str) -> str:
    """Without include guards and extern "C", which tell a reader nothing."""
    lines = [line for line in block.splitlines() if not re.match(r"#(ifndef|define|endif).*_H\b|#include|#ifdef "
                                                                  "__cplusplus", line)]
    return "\n".join(lines).strip("\n")


def _is_frame(block: str) -> bool:
    frame = re.compile(r"#|\}$|extern \"C\"|/\* extern")
    lines = [line.strip() for line in block.splitlines() if line.strip()]
    return all(frame.match(line) for line in lines) and "#define LACONIC_MAX" not in block
