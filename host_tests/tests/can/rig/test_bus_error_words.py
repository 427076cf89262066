"""What the user reads when a bus cannot be opened or dies: the system's reason or the driver's, nothing of Python's."""

from __future__ import annotations

import errno
from pathlib import Path

import can
import pytest

from laconic.can.rig.errors import UNEXPECTED, in_words
from laconic.cli.main import run


def caused(error: Exception, cause: Exception) -> Exception:
    error.__cause__ = cause
    return error


WORDS = {
    "the system's": (OSError(errno.ECONNREFUSED, "[Errno 111] Connection refused"), "connection refused"),
    "a text with the system's number": (OSError("could not open port x: [Errno 2] No such file"),
                                        "no such file or directory"),
    "a driver's": (can.CanOperationError("the adapter was unplugged"), "the adapter was unplugged"),
    "a driver's with the system's behind it": (
        caused(can.CanInitializationError("could not open"), PermissionError(errno.EACCES, "x")), "permission denied"),
    "a number that is none": (ValueError("invalid literal for int() with base 10: 'x'"), UNEXPECTED),
    "too few values": (IndexError("list index out of range"), UNEXPECTED),
}


@pytest.mark.parametrize(("error", "words"), WORDS.values(), ids=WORDS)
def test_an_error_of_a_bus_is_told_in_the_systems_or_the_drivers_words(error: Exception, words: str) -> None:
    assert in_words(error) == words


REFUSED = {
    "no such port": (["--interface", "slcan", "--channel", "/dev/no-such-port"], "(no such file or directory)"),
    "nobody listens": (["--interface", "slcan", "--channel", "socket://127.0.0.1:1"], "(connection refused)"),
    "no such interface": (["--interface", "quux", "--channel", "1"], "--interface quux: is not there, or its driver"),
    "settings that it does not accept": (["--interface", "serial", "--channel", "loop://", "--bitrate", "500000",
                                          "--bus-option", "timeout=x"], "--channel loop://: cannot open the bus"),
}


@pytest.mark.parametrize(("options", "words"), REFUSED.values(), ids=REFUSED)
def test_a_bus_that_cannot_be_opened_is_one_line_without_pythons_words(
        options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", *options]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
    assert not any(each in error for each in ("Errno", "Error Code", "invalid literal", "argument"))


@pytest.mark.parametrize(("data", "words"), [(None, "cannot be read (is a directory)"), (b"\xff\xfe", "holds no key"),
                                             (b"12", "holds no key")])
def test_a_key_that_cannot_be_read_is_one_line(data: bytes | None, words: str, tmp_path: Path,
                                               capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path if data is None else tmp_path / "key"
    if data is not None:
        path.write_bytes(data)
    assert run(["rig", "s1", "--interface", "slcan", "--channel", "socket://127.0.0.1:1", "--key", str(path)]) == 2
    error = capsys.readouterr().err
    assert f"--key {path}: {words}" in error and "codec" not in error and error.count("\n") == 1
