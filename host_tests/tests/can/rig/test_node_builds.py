"""The node compiles without warnings in the shapes that firmware chooses, and refuses those that it cannot serve."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from laconic.base.paths import SOURCE_DIR, build_dir

FIRMWARE = SOURCE_DIR / "firmware_stub"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wdouble-promotion", "-Werror",
          "-ffp-contract=off", "-fsyntax-only")
INCLUDES = (SOURCE_DIR / "core_c" / "include", FIRMWARE / "include", FIRMWARE / "node", FIRMWARE / "drives")
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]


def compiled(compiler: str, *definitions: str, only: str = "*.c") -> str:
    """The messages of the compiler about the files of the node."""
    paths = [path for room in ("wire", "node", "drives") for path in sorted((FIRMWARE / room).rglob(only))]
    files = [str(path) for path in paths]
    where = [word for path in INCLUDES for word in ("-I", str(path))]
    where += ["-isystem", str(build_dir() / "firmware_stub" / "wire")]
    done = subprocess.run([compiler, *STRICT, *where, *(f"-D{each}" for each in definitions), *files],
                          capture_output=True, text=True)
    return done.stderr if done.returncode else ""


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("definitions", [
    (), ("LACONIC_MAX_WHEELS=24", "LACONIC_NODE_WITH_SENSORS=0"),
    ("LACONIC_NODE_WITH_DRIVES=0", "LACONIC_WITH_AXLE_TORQUE=0"),
    ("LACONIC_NODE_WITH_SENSORS=0",), ("LACONIC_NODE_WITH_ESTIMATE=1",),
    ("LACONIC_NODE_WITH_SENSORS=0", "LACONIC_NODE_WITH_ESTIMATE=1", "LACONIC_NODE_WITH_DRIVES=0"),
    ("LACONIC_SINGLE", "LACONIC_NODE_CAN_FD=0", "LACONIC_MAX_WHEELS=4", "LACONIC_MAX_SUPPORTS=1")], ids=" ".join)
def test_the_node_compiles_without_a_warning(compiler: str, definitions: tuple[str, ...]) -> None:
    assert compiled(compiler, *definitions) == ""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_more_wheels_than_the_groups_of_voltage_can_number_do_not_compile(compiler: str) -> None:
    assert "VOLTAGE numbers eight groups of three wheels" in compiled(
        compiler, "LACONIC_MAX_WHEELS=25", only="node_motion.c")


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", ["main.c", "station.c"])
def test_the_host_port_needs_nothing_of_linux_but_for_socketcan(compiler: str, name: str) -> None:
    path = FIRMWARE / "ports" / "host" / name
    where = [word for folder in (*INCLUDES, build_dir() / "firmware_stub" / "wire") for word in ("-I", str(folder))]
    done = subprocess.run([compiler, *STRICT, "-U__linux__", "-H", *where, str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "linux/can" not in done.stderr
    words = set(re.findall(r"\w+", re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)))
    assert words & {"ppoll", "accept4", "SOCK_NONBLOCK", "SOCK_CLOEXEC", "MSG_NOSIGNAL"} == set()
