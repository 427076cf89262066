"""The `laconic` command: each subcommand is a module of laconic.cli.commands, loaded when it is called."""

from __future__ import annotations

import importlib
import logging
import os
import pkgutil
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

import laconic.cli.commands
from laconic.base.extras import missing_module
from laconic.base.paths import check_installation
from laconic.cli.streams import SHELL_SIGNAL, SIGPIPE, ReaderGone, guard, let_signals_end, stop_status
from laconic.errors import BadInput, LaconicError, nearest_of, reason_of


class LazyCommands(click.Group):
    """Finds subcommands by file name; a module is imported only when its command runs or explains itself."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        names = (module.name for module in pkgutil.iter_modules(laconic.cli.commands.__path__))
        return sorted(name for name in names if not name.startswith("_"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            raise click.UsageError(f"no command {cmd_name}; {nearest_of(cmd_name, self.list_commands(ctx))}", ctx)
        check_installation()
        return importlib.import_module(f"laconic.cli.commands.{cmd_name}").command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, summary(name)) for name in self.list_commands(ctx)])

    def invoke(self, ctx: click.Context) -> Any:
        """Runs the command; an error becomes our one line before click or Python print it in theirs."""
        try:
            return super().invoke(ctx)
        except (LaconicError, click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except KeyboardInterrupt as stopped:
            raise Ended(*stop_status(stopped)) from None
        except Exception as error:
            raise unexpected(error) from error


def summary(command: str) -> str:
    """The line of `laconic --help` for a command: the docstring of its module, read without an import."""
    import ast

    source = Path(laconic.cli.commands.__path__[0], f"{command}.py").read_text(encoding="utf-8")
    return ast.get_docstring(ast.parse(source)) or ""


class Ended(LaconicError):
    """A signal ended the command."""

    def __init__(self, message: str, exit_status: int):
        super().__init__(message)
        self.exit_status = exit_status


@click.group(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 97})
@click.version_option(package_name="laconic", message="laconic %(version)s")
def commands() -> None:
    """The dynamics of wheeled robots: simulate, verify, wrap as FMU, drive over CAN."""


def main(arguments: list[str] | None = None) -> None:
    """Runs a command and ends the process with its exit status.

    0; 1 for a result that fails; 2 for anything that keeps the command from its result, with one line on stderr;
    130 after Ctrl-C, 143 after SIGTERM; 141 when the reader of stdout has gone (| head -1), silently, as for any tool.
    """
    guard()
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns of a home folder that it cannot write
    try:
        status = run(sys.argv[1:] if arguments is None else arguments)
        let_signals_end()
    except KeyboardInterrupt as again:  # a second signal, while the first one was told
        let_signals_end()
        status = stop_status(again)[1]
    with suppress(ReaderGone, BadInput):  # text before an error that stderr already states
        sys.stdout.flush()
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """The exit status of a command line."""
    try:
        result = commands.main(arguments, prog_name="laconic", standalone_mode=False)
        sys.stdout.flush()
        return result if isinstance(result, int) else 0
    except ReaderGone:
        return SHELL_SIGNAL + SIGPIPE
    except LaconicError as error:
        return fail(shortened(str(error), arguments), error.exit_status)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.ctx.get_help(), err=True)
        return 2
    except click.ClickException as error:
        return fail(shortened(usage(error), arguments), 2)
    except (click.Abort, KeyboardInterrupt) as stopped:
        return fail(*stop_status(stopped))


LONGEST_ECHO = 60  # of a value of the command line in a message
LONGEST_NAME = 255  # of a file


def shortened(message: str, arguments: Sequence[str]) -> str:
    """The message with what the user gave cut to what a person needs to know it again; names of files stay whole."""
    line = " ".join(message.split())
    given = {" ".join(part.split()) for each in arguments for part in (each, each.partition("=")[2])}
    for part in sorted(given, key=len, reverse=True):
        if len(part) > LONGEST_ECHO and not (os.sep in part or Path(part[:LONGEST_NAME]).exists()):
            line = line.replace(part, part[:LONGEST_ECHO - 1] + "…")
    return line


def usage(error: click.ClickException) -> str:
    """The message of click in one line, with the help to read."""
    context = getattr(error, "ctx", None)
    more = f"; see {context.command_path} --help" if context else ""
    return error.format_message().rstrip(".") + more


def unexpected(error: Exception) -> LaconicError:
    """An error of the system, of a library or of ours, as one line; LACONIC_TRACEBACK=1 shows where it came from."""
    if os.environ.get("LACONIC_TRACEBACK"):
        traceback.print_exception(error)
    if isinstance(error, OSError) and error.strerror:
        return BadInput(f"{error.filename}: {reason_of(error)}" if error.filename else f"error: {reason_of(error)}")
    if isinstance(error, MemoryError):
        return BadInput("there is not enough memory for this; run fewer steps or outputs")
    if isinstance(error, ModuleNotFoundError):
        return missing_module(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    return BadInput(f"unexpected fault of the program ({Path(last.filename).name}:{last.lineno}); LACONIC_TRACEBACK=1 "
                    "in the environment shows more, for a report of it")


def fail(message: str, status: int) -> int:
    """Prints the reason on stderr, in one line."""
    with suppress(OSError):  # nobody reads stderr either
        line = " ".join(message.split())
        click.echo("laconic: " + "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line), err=True)
    return status
