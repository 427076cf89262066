"""The `laconic` command: each subcommand is a module of laconic.commands, loaded when it is called."""

from __future__ import annotations

import importlib
import os
import pkgutil
import sys

import click

import laconic.commands
from laconic.errors import LaconicError, nearest_of


class LazyCommands(click.Group):
    """Finds subcommands by file name, so that adding one touches no common file."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        names = (module.name for module in pkgutil.iter_modules(laconic.commands.__path__))
        return sorted(name for name in names if not name.startswith("_"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            raise click.UsageError(f"no command {cmd_name}; {nearest_of(cmd_name, self.list_commands(ctx))}", ctx)
        return importlib.import_module(f"laconic.commands.{cmd_name}").command


@click.group(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="laconic", message="laconic %(version)s")
def commands() -> None:
    """The dynamics of wheeled robots: simulate, verify, wrap as FMU, drive over CAN."""


def main(arguments: list[str] | None = None) -> None:
    """Runs a command; exit status 0, 1 for a result that fails, 2 for bad input with one line on stderr."""
    sys.exit(run(sys.argv[1:] if arguments is None else arguments))


def run(arguments: list[str]) -> int:
    """The exit status of a command line."""
    try:
        result = commands.main(arguments, prog_name="laconic", standalone_mode=False)
        return result if isinstance(result, int) else 0
    except LaconicError as error:
        return fail(str(error), error.exit_status)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.ctx.get_help(), err=True)
        return 2
    except click.ClickException as error:
        return fail(usage(error), 2)
    except (click.Abort, KeyboardInterrupt):
        return fail("stopped by the user", 130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def usage(error: click.ClickException) -> str:
    """What click says, in one line, with where to read more."""
    context = getattr(error, "ctx", None)
    more = f"; see {context.command_path} --help" if context else ""
    return error.format_message().rstrip(".") + more


def fail(message: str, status: int) -> int:
    """Says why on stderr, in one line."""
    click.echo("laconic: " + " ".join(message.split()), err=True)
    return status


if __name__ == "__main__":
    main()
