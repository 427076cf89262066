"""What a command may write: never over one of its inputs, never twice to one file, each file whole or not at all.

Options claim their files while the command line is read, before any work is done; whatever writes goes through
`write_text`, `opened` or `whole_file`, which hold to the same rule. Files are compared as the system does, so a link,
hard or symbolic, is the file that it leads to; stdout is a file too. Devices and pipes may be written to at any time.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import click

from laconic.errors import BadInput, reason_of

STDOUT = Path("-")
OF_RUN = "laconic.base.outputs"  # where click keeps the claims of the running command


@dataclass
class Claims:
    """The files of one run: what it reads, what its options claim, what it has written."""

    inputs: list[Path] = field(default_factory=list)
    outputs: list[tuple[str, Path]] = field(default_factory=list)
    written: list[Path] = field(default_factory=list)

    def read(self, path: Path) -> None:
        """Notes an input; BadInput when an option writes to it."""
        self.inputs.append(path)
        for option, output in self.outputs:
            self._refuse_input(option, output)

    def claim(self, option: str, path: Path) -> None:
        """Notes the file of an output option; BadInput when it is an input or another option's."""
        self._refuse_input(option, path)
        for other, taken in self.outputs:
            if same_file(path, taken):
                raise BadInput(f"{option} {path}: is where {other} writes, too; give each a file of its own")
        self.outputs.append((option, path))

    def write(self, path: Path) -> None:
        """Notes that a file is written now; BadInput when it is an input or was written before."""
        self._refuse_input("", path)
        if any(same_file(path, before) for before in self.written):
            raise BadInput(f"{path}: would be written twice by this command; give each output a name of its own")
        self.written.append(path)

    def _refuse_input(self, option: str, path: Path) -> None:
        if any(same_file(path, each) for each in self.inputs):
            raise BadInput(f"{option} {path}: is a file that this command reads; choose another name".strip())


def claims(context: click.Context | None = None) -> Claims:
    """Those of the running command; fresh ones where no command runs."""
    context = context or click.get_current_context(silent=True)
    return Claims() if context is None else context.meta.setdefault(OF_RUN, Claims())


def same_file(one: Path, other: Path) -> bool:
    """Whether two names lead to one file; what is no file (a device, a pipe) never is the same."""
    if is_stdout(one) or is_stdout(other):
        return is_stdout(one) and is_stdout(other)
    if is_special(one) or is_special(other):
        return False
    try:
        return one.samefile(other)
    except OSError:  # one of them is not there yet
        return os.path.realpath(one) == os.path.realpath(other)


def is_special(path: Path) -> bool:
    """A device, pipe or socket: written to as it is, not replaced."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def is_stdout(path: Path) -> bool:
    """"-", a name of stdout's own, or the file that the shell's > leads it to."""
    if path == STDOUT or str(path) in ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
        return True
    try:
        ours, theirs = os.fstat(1), path.stat()
    except (OSError, ValueError):
        return False
    return stat.S_ISREG(theirs.st_mode) and os.path.samestat(ours, theirs)


def claim_file(option: str, path: Path, endings: tuple[str, ...] = (), context: click.Context | None = None) -> Path:
    """Claims an output file before any work is done; BadInput where it cannot be one."""
    check_ending(option, path, endings)
    claims(context).claim(option, path)
    check_file(option, path)
    return path


def check_file(option: str, path: Path) -> None:
    """BadInput where no file can be written, before any work is done."""
    if not is_stdout(path):
        _check_writable(option, path, is_folder=False)


def claim_folder(option: str, path: Path) -> Path:
    """An output folder, which is made with its first file; BadInput where there cannot be one."""
    _check_writable(option, path, is_folder=True)
    return path


def check_ending(option: str, path: Path, endings: tuple[str, ...]) -> None:
    """BadInput when a file's name does not end as its format does; "-" and devices need no ending."""
    if endings and not (path.suffix.lower() in endings or is_stdout(path) or is_special(path)):
        ends = " or ".join([", ".join(endings[:-1]), endings[-1]] if endings[1:] else endings)
        if path.is_dir():
            raise BadInput(f"{option} {path}: is a folder; give the name of a file in it that ends in {ends}")
        what = f"cannot be a {path.suffix} file" if path.suffix else "has no ending"
        raise BadInput(f"{option} {path}: {what}; choose a name that ends in {ends}")


def _check_writable(option: str, path: Path, is_folder: bool) -> None:
    """What can be known beforehand: a folder is no file, a file no folder, and one may write there."""
    try:
        if path.exists():
            if path.is_dir() != is_folder:
                there = "folder" if path.is_dir() else "file"
                raise BadInput(f"{option} {path}: cannot be written (there is a {there} of that name); "
                               "choose another name")
            existing = path
        else:
            existing = next(each for each in (path.parent, *path.parent.parents, Path()) if each.exists())
            if not existing.is_dir():
                raise BadInput(f"{option} {path}: cannot be written ({existing} is no folder); choose another path")
    except (OSError, ValueError) as error:
        raise _cannot(path, error) from None
    if not os.access(existing, os.W_OK):
        raise BadInput(f"{option} {path}: cannot be written ({existing} is read-only); choose another path")
    if not is_special(path):
        _try_folder(option, path, existing if existing.is_dir() else Path(os.path.realpath(path)).parent)


def _try_folder(option: str, path: Path, folder: Path) -> None:
    """BadInput where no file can be made in a folder, whatever its permissions say: /proc, a full disk."""
    trial = folder / f".laconic-{secrets.token_hex(8)}.part"
    try:
        os.close(os.open(trial, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        trial.unlink()
    except OSError as error:
        raise BadInput(f"{option} {path}: cannot be written ({folder}: {reason_of(error)}); choose another "
                       "path") from None


def _cannot(path: Path, error: OSError | ValueError) -> BadInput:
    reason = reason_of(error) if isinstance(error, OSError) else str(error)
    return BadInput(f"{path}: cannot be written ({reason}); choose another path")


def make_folder(folder: Path) -> None:
    """A folder with those above it; a command says so on stderr, since a name typed wrong makes one, too."""
    if folder.is_dir():
        return
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR)) from None
    if click.get_current_context(silent=True) is not None:
        click.echo(f"laconic: made the folder {folder}", err=True)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """The name of a new file beside `path` to be filled, which takes its place in the end.

    Whatever goes wrong on the way, a signal included, leaves what was there before. Folders on the way are made. A
    link stays one; a device or pipe is given as it is. BadInput says why a file cannot be written.
    """
    claims().write(path)
    target = Path(os.path.realpath(path))
    fresh = target if is_special(path) else target.with_name(f".laconic-{secrets.token_hex(8)}.part")
    try:
        make_folder(path.parent)
        target.parent.mkdir(parents=True, exist_ok=True)
        if fresh != target:
            _create(fresh, like=target)
        yield fresh
        if fresh != target:
            fresh.replace(target)
    except OSError as error:
        raise _cannot(path, error) from None
    finally:
        if fresh != target:
            with suppress(OSError):
                fresh.unlink()


def _create(fresh: Path, like: Path) -> None:
    """An empty file with the permissions of the one that it will replace."""
    there = like.exists()
    if there and not os.access(like, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    os.close(os.open(fresh, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    if there:
        fresh.chmod(stat.S_IMODE(like.stat().st_mode))


@contextmanager
def opened(path: Path, mode: str = "w") -> Iterator[IO[Any]]:
    """A file open for writing; text is UTF-8 with line ends as they are given. "-" is stdout, for text alone."""
    if is_stdout(path):
        yield sys.stdout
        return
    encoding, newline = (None, None) if "b" in mode else ("utf-8", "")
    with whole_file(path) as fresh, fresh.open(mode, encoding=encoding, newline=newline) as file:
        yield file


def write_text(path: Path, text: str) -> None:
    """A text file, or text on stdout."""
    with opened(path) as file:
        file.write(text)
