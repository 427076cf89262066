"""Command line for the build: tables, FMUs, and the token of modelDescription.xml."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import archive, fmi2, fmi3
from .archive import pack
from .description import identifier_in, parse, token_in, token_of, with_identifier, with_token
from .field_list import differing_item, methods_in, missing_variable, with_items
from .for_vehicle import for_vehicle, of_step, with_estimate, without_estimate
from .licences import licence_parts, ziglang_in
from .names import with_own_names
from .slipping import of_slipping, without_slip
from .tables import tables


def make_tables(arguments: argparse.Namespace) -> None:
    """Writes the variable table and the descriptions into a folder."""
    text_3 = arguments.description.read_text(encoding="utf-8")
    if token_in(text_3) != token_of(text_3):
        sys.exit(f"{arguments.description}: its token does not belong to its text any more: "
                 f"python -m laconic_fmu renew-token {arguments.description}")
    try:
        description = parsed = parse(text_3)
    except ValueError as wrong:
        sys.exit(f"{arguments.description}: {wrong}")
    for header in arguments.fields:
        if fault := missing_variable(header, arguments.description, description):
            sys.exit(fault)
    if arguments.methods and (fault := differing_item(arguments.methods, arguments.description, description)):
        sys.exit(fault)
    description = of_slipping(description) if arguments.slipping else without_slip(description)
    description = with_estimate(description) if arguments.estimate else without_estimate(description)
    generic = for_vehicle(description)
    if arguments.of_step:
        generic = of_step(generic)
    generic = with_identifier(generic, arguments.identifier or identifier_in(parsed.root))
    if generic is not parsed:
        text_3 = fmi3.describe(generic)
    out: Path = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    if arguments.versions == ["3"]:  # bus terminals, without arrays
        text_3 = fmi3.describe_scalar(generic)
        (out / "variable_table.c").write_text(tables(description, text_3, text_3), encoding="utf-8")
        (out / "fmi3.xml").write_text(text_3, encoding="utf-8")
        return
    text_2 = fmi2.describe(generic, [*arguments.sources, "fmi2.c"])
    (out / "variable_table.c").write_text(tables(description, text_3, text_2), encoding="utf-8")
    (out / "fmi2.xml").write_text(text_2, encoding="utf-8")
    (out / "fmi3.xml").write_text(text_3, encoding="utf-8")


def make_fmu(arguments: argparse.Namespace) -> None:
    """Packs an FMU from `part=file` pairs."""
    identifier = arguments.identifier
    parts = {"modelDescription.xml": arguments.description.read_bytes()}
    in_archive = {name: Path(file) for name, _, file in (pair.partition("=") for pair in arguments.sources)}
    own = with_own_names({name: file.read_bytes() for name, file in in_archive.items()}, identifier, arguments.version)
    parts |= {f"sources/{name}": data for name, data in own.items()}
    sources = [name for name in in_archive if name.endswith(".c")]
    platforms = []
    for pair in arguments.binaries:
        platform, _, file = pair.partition("=")
        platforms.append(platform)
        parts[archive.binary_name(arguments.version, platform, identifier)] = Path(file).read_bytes()
    for pair in arguments.parts:
        name, _, file = pair.partition("=")
        parts[name] = Path(file).read_bytes()
    zig = ziglang_in(arguments.zig.parents[1]) if arguments.zig else None
    parts |= licence_parts(arguments.licence.read_bytes(), arguments.headers / "fmi3FunctionTypes.h", in_archive,
                           platforms, zig)
    if arguments.version == 3:
        parts["sources/buildDescription.xml"] = archive.build_description(sources, identifier).encode("utf-8")
    pack(arguments.out, parts)


def renew_token(arguments: argparse.Namespace) -> None:
    """Gives modelDescription.xml the token that belongs to its text."""
    text = arguments.description.read_text(encoding="utf-8")
    arguments.description.write_text(with_token(text), encoding="utf-8")


def renew_methods(arguments: argparse.Namespace) -> None:
    """Gives modelDescription.xml the core's methods, and the token that belongs to its text."""
    text = arguments.description.read_text(encoding="utf-8")
    methods = methods_in(arguments.header.read_text(encoding="utf-8"))
    arguments.description.write_text(with_token(with_items(text, methods)), encoding="utf-8")


def main() -> None:
    """Runs the subcommand on the command line."""
    parser = argparse.ArgumentParser(prog="laconic_fmu", description=__doc__)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("tables")
    command.add_argument("description", type=Path)
    command.add_argument("--out", type=Path, required=True)
    command.add_argument("--identifier", help="the modelIdentifier, if it is not that of the description")
    command.add_argument("--sources", nargs="*", default=[])
    command.add_argument("--versions", nargs="*", default=["2", "3"], help="the FMI versions of this FMU")
    command.add_argument("--fields", type=Path, nargs="*", default=[],
                         help="headers with the core's lists of fields, each of which must be a variable")
    command.add_argument("--methods", type=Path,
                         help="the header with the core's list of methods, each of which must be an item")
    command.add_argument("--of-step", action="store_true", help="derivatives of communication steps")
    command.add_argument("--estimate", action="store_true", help="with an error estimate")
    command.add_argument("--slipping", action="store_true", help="of a vehicle with hinges on ground with friction")
    command.set_defaults(run=make_tables)
    command = commands.add_parser("pack")
    command.add_argument("--version", type=int, choices=(2, 3), required=True)
    command.add_argument("--identifier", required=True, help="the modelIdentifier")
    command.add_argument("--description", type=Path, required=True)
    command.add_argument("--sources", nargs="*", default=[])
    command.add_argument("--binaries", nargs="*", default=[])
    command.add_argument("--parts", nargs="*", default=[])
    command.add_argument("--licence", type=Path, required=True, help="our own")
    command.add_argument("--headers", type=Path, required=True, help="the folder of the FMI headers")
    command.add_argument("--zig", type=Path, help="the interpreter whose package ziglang made the binaries")
    command.add_argument("--out", type=Path, required=True)
    command.set_defaults(run=make_fmu)
    command = commands.add_parser("renew-token")
    command.add_argument("description", type=Path)
    command.set_defaults(run=renew_token)
    command = commands.add_parser("renew-methods")
    command.add_argument("description", type=Path)
    command.add_argument("header", type=Path, help="with the core's list of methods")
    command.set_defaults(run=renew_methods)
    arguments = parser.parse_args()
    arguments.run(arguments)


if __name__ == "__main__":
    main()
