"""The platforms that wheels are made for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    """One of them: its tag in the wheel's name, how zig calls it, and how its files are named."""

    name: str
    tag: str
    target: str
    library: str = "lib{}.so"
    has_node_process: bool = True  # its sockets are those of POSIX

    @property
    def is_linux(self) -> bool:
        """Whether it has CAN interfaces in its kernel."""
        return "linux" in self.target

    @property
    def is_windows(self) -> bool:
        """Whether code is at any address without being told so."""
        return self.library.endswith(".dll")


MAC = "lib{}.dylib"
PLATFORMS = {each.name: each for each in (
    Platform("linux-x86_64", "manylinux_2_17_x86_64.manylinux2014_x86_64", "x86_64-linux-gnu.2.17"),
    Platform("linux-aarch64", "manylinux_2_17_aarch64.manylinux2014_aarch64", "aarch64-linux-gnu.2.17"),
    Platform("musl-x86_64", "musllinux_1_2_x86_64", "x86_64-linux-musl"),
    Platform("musl-aarch64", "musllinux_1_2_aarch64", "aarch64-linux-musl"),
    Platform("windows-x86_64", "win_amd64", "x86_64-windows-gnu", "{}.dll", has_node_process=False),
    Platform("macos-x86_64", "macosx_11_0_x86_64", "x86_64-macos.11.0", MAC),
    Platform("macos-arm64", "macosx_11_0_arm64", "aarch64-macos.11.0", MAC))}
