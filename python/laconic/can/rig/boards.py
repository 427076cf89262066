"""Nodes that the rig starts itself: in this process, in a process of its own, on an emulated Cortex-M board."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from laconic.base.paths import build_dir, built, sources_missing
from laconic.can.rig import with_parent
from laconic.can.rig.buses import connected, process_node, virtual_node
from laconic.can.rig.choices import BOARDS, KINDS
from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import CannotReach
from laconic.can.rig.wire import ID_BASE
from laconic.errors import BadInput, nearest_of

QEMU = "qemu-system-arm"
QEMU_START_S = 10.0


def why_no_emulation() -> str | None:
    """Message on what emulated boards lack here; None when nothing is missing."""
    if missing := sources_missing():
        return f"images of boards are compiled from {missing}"
    if shutil.which(QEMU) is None:
        return f"{QEMU} is missing: install the package qemu-system-arm"
    if not (build_dir() / "firmware" / "laconic-node-an386.elf").exists():
        return "no firmware images: install gcc-arm-none-eabi and libnewlib-arm-none-eabi, and build again"
    return None


def free_port() -> int:
    """A TCP port that was free just now."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


@contextmanager
def emulated(name: str) -> Iterator[int]:
    """A board under QEMU; yields the TCP port of its UART. It also ends with the thread that started it."""
    if reason := why_no_emulation():
        raise BadInput(f"--board {name}: {reason}")
    board, port = BOARDS[name], free_port()
    image = built(f"firmware/laconic-node-{name}.elf")
    serial = f"tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"
    emulation = [QEMU, "-M", board.machine, "-kernel", str(image), "-display", "none", "-monitor", "none",
                 "-serial", serial]
    command = [sys.executable, with_parent.__file__, str(os.getpid()), *emulation]
    # in another session: Ctrl-C goes to the rig only, which brings the node to rest before it ends it
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True, start_new_session=True) as process:
        try:
            wait_for_port(process, port)
            yield port
        finally:
            process.kill()


def wait_for_port(process: subprocess.Popen[str], port: int) -> None:
    """Until QEMU listens."""
    deadline = time.monotonic() + QEMU_START_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise CannotReach(f"{QEMU} ended at once: {process.communicate()[1].strip()}")
        if f"0100007F:{port:04X} 00000000:0000 0A" in Path("/proc/net/tcp").read_text(encoding="ascii"):
            return
        time.sleep(0.02)
    raise CannotReach(f"{QEMU} does not listen on port {port} after {QEMU_START_S:g} s")


@contextmanager
def emulated_node(name: str) -> Iterator[NodeClient]:
    """A client of an emulated board."""
    with emulated(name) as port, connected("slcan", f"socket://127.0.0.1:{port}") as client:
        client.timeout_s = 5.0
        yield client


def own_node(kind: str, real: str, id_base: int = ID_BASE) -> AbstractContextManager[NodeClient]:
    """A node of the given kind, started here and ended with the context."""
    if kind == "virtual":
        return virtual_node(real, id_base)
    if kind == "process":
        return process_node(real, id_base)
    if kind not in BOARDS:
        raise BadInput(f"--board {kind}: no such board; {nearest_of(kind, KINDS)}")
    if id_base != ID_BASE:
        raise BadInput(f"--board {kind}: the images listen at ID base 0x{ID_BASE:X}; leave --id-base out")
    return emulated_node(kind)
