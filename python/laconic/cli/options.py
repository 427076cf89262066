"""Options and arguments of the command line: those that name files, and those that do not go together.

Every argument that names a file has one of the types below, so that no command writes over what it reads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from laconic.base import outputs
from laconic.base.paths import exists, named_scene
from laconic.errors import BadInput

PICTURES = (".png", ".svg", ".pdf")


class InputPath(click.ParamType[Path]):
    """A file or folder that a command reads; the reader names what is wrong with it."""

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path, noted as an input."""
        path = _path(value, param)
        if exists(path):
            outputs.claims(ctx).read(path)
        return path


class OutputBag(click.ParamType[Path]):
    """A recording that a command writes: FILE.mcap, or a new folder."""

    name = "bag"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path, claimed for this option."""
        from laconic.robot.bags.run_topics import check_bag

        path, option = _path(value, param), _spelled(param)
        if path.suffix.lower() == ".mcap":
            return outputs.claim_file(option, path, (".mcap",), ctx)
        check_bag(option, path)
        outputs.claims(ctx).claim(option, path)
        return outputs.claim_folder(option, path)


STORAGES = ("sqlite3", "mcap")  # of a rosbag2, by the names that ROS has for them


class RerunTarget(click.ParamType[Path]):
    """FILE.rrd, or nothing: the viewer itself, which is the path without a name."""

    name = "rrd"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path, claimed for this option."""
        if not str(value):
            return Path()
        path = Path(value)
        if path.suffix.lower() != ".rrd":
            raise BadInput(f"--rerun {value}: is no name of a recording; choose a name that ends in .rrd, or put "
                           "--rerun last, to start the viewer")
        return outputs.claim_file("--rerun", path, (".rrd",), ctx)


def recorded_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a run that others look at: --bag, --storage, --foxglove, --rerun, together as `recorded`."""

    @wraps(command)
    def recording(*words: Any, bag: Path | None, storage: str | None, foxglove: Path | None, rerun: Path | None,
                  **more: Any) -> Any:
        from laconic.pictures.views.recorded import Recorded

        check_storage(bag, storage)
        return command(*words, recorded=Recorded(bag, storage, foxglove, rerun), **more)

    found: Callable[..., Any] = recording
    for option in (
            click.option("--rerun", type=RerunTarget(), is_flag=False, flag_value="", metavar="[FILE.rrd]",
                         help="Show the run in the viewer of Rerun, or write it for it."),
            click.option("--foxglove", type=OutputFile(".mcap"), metavar="FILE.mcap",
                         help="Write the run for Foxglove, and FILE.layout.json, which arranges it there."),
            click.option("--storage", type=click.Choice(STORAGES),
                         help="Of the folder that --bag names.  [default: sqlite3]"),
            click.option("--bag", type=OutputBag(), metavar="BAG",
                         help="Write the run as topics of ROS 2: FILE.mcap, or a new folder for a rosbag2.")):
        found = option(found)
    return found


def check_storage(bag: Path | None, storage: str | None) -> None:
    """BadInput for a storage without a folder that has one."""
    if storage is not None and (bag is None or bag.suffix.lower() == ".mcap"):
        raise BadInput(f"--storage {storage}: is of a rosbag2, which is a folder; give --bag FOLDER, or leave it out")


class SceneName(click.ParamType[str]):
    """A scene by its path or by its name; it stays as it was given, for `read_scene`.

    One with bodies on hinges is refused unless the command takes them.
    """

    name = "scene"

    def __init__(self, hinges: bool = False):
        self.takes_hinges = hinges

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The name; its file is noted as an input."""
        _path(value, param)
        if path := named_scene(value):
            outputs.claims(ctx).read(path)
            if not self.takes_hinges:
                _check_rigid(path, f"laconic {ctx.info_name}" if ctx and ctx.info_name else "this")
        return value


def _check_rigid(path: Path, command: str) -> None:
    from laconic.scene.hinges import WITHOUT_HINGES, file_has_hinges  # loads the core

    if file_has_hinges(path):
        raise BadInput(f"{path}: {command} does not take vehicles with hinges (steered wheels, casters, trailers) yet; "
                       f"use laconic simulate, or {WITHOUT_HINGES}")


class ReferenceOrScene(click.ParamType[str]):
    """A reference file, or a scene by its path or name."""

    name = "reference"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """As it was given; its file is noted as an input."""
        if is_scene(value):
            return SceneName().convert(value, param, ctx)
        return str(InputPath().convert(value, param, ctx))


def is_scene(given: str) -> bool:
    """Whether it is the path of a scene, or the name of one: no file, and not as a reference file is named."""
    path = Path(given)
    return bool(given) and (path.suffix == ".toml" or not (path.suffix == ".json" or exists(path)))


class OutputFile(click.ParamType[Path]):
    """A file that a command writes, in a format with these endings; "-" for stdout where that makes sense."""

    name = "file"

    def __init__(self, *endings: str, stdout: bool = False):
        self.endings, self.stdout = endings, stdout

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path, claimed for this option."""
        path, option = _path(value, param), _spelled(param)
        if outputs.is_stdout(path) and not self.stdout:
            raise BadInput(f"{option} {path}: cannot go to stdout; give the name of a file")
        return outputs.claim_file(option, path, self.endings, ctx)


class OutputFolder(click.ParamType[Path]):
    """A folder that a command writes files into, made if it is not there."""

    name = "folder"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path; BadInput where there can be no folder."""
        return outputs.claim_folder(_spelled(param), _path(value, param))


def _spelled(param: click.Parameter | None) -> str:
    if param is None:
        return ""
    return max(param.opts, key=len) if isinstance(param, click.Option) else (param.name or "").upper()


def _path(value: Any, param: click.Parameter | None) -> Path:
    if not str(value):  # Path("") is the current folder
        raise BadInput(f"{_spelled(param)}: is empty; give a name")
    return Path(value)


def json_flag(meaning: str = "Machine-readable output.") -> Callable[[Any], Any]:
    """`--json` of a command that prints JSON instead of its text: stdout is then taken."""

    def claim(ctx: click.Context, param: click.Parameter, is_on: bool) -> bool:
        if is_on:
            outputs.claim_file("--json", outputs.STDOUT, context=ctx)
        return is_on

    return click.option("--json", "json_wanted", is_flag=True, help=meaning, callback=claim)


def one_of(name: str, choices: Sequence[str], meaning: str, **more: Any) -> Callable[[Any], Any]:
    """An option with many choices: they stand in its help, which is wrapped, and not in one long line before it."""
    return click.option(name, type=click.Choice(choices), metavar=name.lstrip("-").upper(),
                        help=f"{meaning}: {', '.join(choices)}.", **more)


def all_methods() -> tuple[str, ...]:
    """Of all vehicles; those for hinges alone come last."""
    from laconic.core.articulated import method_names  # loads the core
    from laconic.scene import METHODS

    return tuple(dict.fromkeys((*METHODS, *method_names())))


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
        name = max(parameter.opts, key=len)
        if given and not is_on and name in options:
            raise BadInput(f"{name}: has a meaning with {flag} alone; leave it out, or add {flag}")


def goes_with(flag: str, *options: str) -> None:
    """BadInput for an option that was given beside a flag, or a scene in words, that makes no use of it."""
    remedy = "leave one of them out" if flag.startswith("--") else "leave it out"
    context = click.get_current_context()
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name) is ParameterSource.COMMANDLINE
        name = max(parameter.opts, key=len)
        if given and isinstance(parameter, click.Option) and name != flag and name not in options:
            raise BadInput(f"{name}: has no meaning beside {flag}; {remedy}")


def check_step(step_s: float | None) -> None:
    """BadInput for a --step that no run can take."""
    if step_s is not None and not 0.0 < step_s < float("inf"):
        raise BadInput(f"--step: {step_s:g} s is not usable; give a finite number above zero")
