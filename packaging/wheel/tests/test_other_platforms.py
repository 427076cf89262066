"""Wheels of other platforms, where an emulator of the platform is installed: cores and FMUs have the bits of this one.

They come from `cmake --workflow --preset wheels`; LACONIC_WHEELS names another folder. Nothing runs macOS here: of its
wheels only the form is checked.
"""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from fresh_environment import PROJECT

import laconic
from laconic.base.paths import build_dir
from laconic.fmu import make
from laconic_build.wheel.contents import LIBRARIES, PLATFORMS, PROGRAMS
from laconic_fmu import archive
from laconic_fmu.cross import compile_to

WHEELS = Path(os.environ.get("LACONIC_WHEELS", PROJECT / "build-fmu-all" / "dist"))
CROSS = Path(os.environ.get("LACONIC_CROSS_PYTHON", WHEELS.parent / "cross" / "bin" / "python"))
ARM_ROOT = Path(os.environ.get("LACONIC_ARM_ROOT", "/usr/aarch64-linux-gnu"))
SCENE = "paper_three_wheel_free"
SHOWN = ("nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad", "wheel_angle_rad[1]")
MAGIC = {".so": b"\x7fELF", ".dll": b"MZ", ".dylib": b"\xcf\xfa\xed\xfe"}
FMU_BINARIES = {"x86_64-windows": "win64/Laconic.dll", "aarch64-linux": "aarch64-linux/Laconic.so",
                "x86_64-linux": "linux64/Laconic.so", "x86_64-darwin": "darwin64/Laconic.dylib",
                "aarch64-darwin": "aarch64-darwin/Laconic.dylib"}


if not (CROSS.exists() and any(WHEELS.glob("laconic-*.whl"))):
    pytest.skip("no wheels of other platforms: cmake --workflow --preset wheels makes them", allow_module_level=True)


@dataclass(frozen=True)
class Runner:
    """How programs of a platform run here."""

    wheel: str
    fmu: str
    command: tuple[str, ...]
    ending: str = ""
    system: str = "linux"  # that runs it where no command is needed

    def lacks(self) -> str:
        """What is not here of what it takes."""
        if not self.command and sys.platform != self.system:
            return f"nothing here runs {self.wheel}: of its wheel and its FMU only the form is checked"
        if self.command and not shutil.which(self.command[0]):
            return f"{self.command[0]} is not installed"
        if "-L" in self.command and not (ARM_ROOT / "lib").exists():
            return f"{ARM_ROOT}: no C library for aarch64; install libc6-arm64-cross"
        return ""


RUNNERS = (Runner("linux-x86_64", "x86_64-linux", ()), Runner("windows-x86_64", "x86_64-windows", ("wine",), ".exe"),
           Runner("linux-aarch64", "aarch64-linux", ("qemu-aarch64-static", "-L", str(ARM_ROOT))),
           Runner("musl-x86_64", "", ("/lib/ld-musl-x86_64.so.1",)),
           Runner("macos-x86_64", "x86_64-darwin", (), system="darwin"),
           Runner("macos-arm64", "aarch64-darwin", (), system="darwin"))


def wheel_of(platform: str) -> zipfile.ZipFile:
    found = list(WHEELS.glob(f"laconic-*-{PLATFORMS[platform].tag}.whl"))
    if not found:
        pytest.skip(f"{WHEELS} has no wheel for {platform}")
    return zipfile.ZipFile(*found)


def run(runner: Runner, folder: Path, *arguments: str) -> list[str]:
    """What the probe, compiled for the platform, prints."""
    program = folder / f"probe{runner.ending}"
    if not program.exists():
        target = PLATFORMS[runner.wheel].target
        compile_to(target, [Path(__file__).with_name("probe.c")], [build_dir() / "parts" / "fmi"], program,
                   [] if runner.ending else ["-ldl"], python=str(CROSS))
    done = subprocess.run([*runner.command, str(program), *arguments], capture_output=True, text=True, check=False,
                          env={**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(folder / "wine")})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.split()


@pytest.fixture(params=RUNNERS, ids=lambda runner: runner.wheel)
def runner(request: pytest.FixtureRequest) -> Runner:
    if lacking := request.param.lacks():
        pytest.skip(lacking)
    return request.param


def test_the_core_of_the_wheel_computes_right_on_its_platform(runner: Runner, tmp_path: Path) -> None:
    wheel_of(runner.wheel).extractall(tmp_path)
    for real in ("double", "single"):
        name = PLATFORMS[runner.wheel].library.format(f"laconic_{real}")
        assert run(runner, tmp_path, "core", str(tmp_path / "laconic" / "_built" / "lib" / name)) == ["0"]


def test_the_fmu_of_the_wheel_has_our_bits_on_its_platform(runner: Runner, tmp_path: Path) -> None:
    if not runner.fmu:
        pytest.skip("the FMU's binary for Linux is that of glibc")
    wheel_of(runner.wheel).extractall(tmp_path)
    scene = laconic.read_scene(SCENE)
    fmu = scene_fmu_of_wheel(scene, tmp_path)
    root = ET.parse(fmu / "modelDescription.xml").getroot()
    references = {each.get("name"): each.get("valueReference", "") for each in root.iter("ScalarVariable")}
    found = run(runner, tmp_path, "fmu", str(fmu / "binaries" / FMU_BINARIES[runner.fmu]), root.get("guid", ""),
                f"file:///{'Z:' if runner.ending else ''}{fmu / 'resources'}", repr(scene.run.duration_s),
                repr(scene.run.step_s), *(references[name] for name in SHOWN))
    ours = laconic.simulate(scene, SHOWN)
    assert found == [bits(ours.columns[name][-1]) for name in SHOWN]


def scene_fmu_of_wheel(scene: laconic.Scene, folder: Path) -> Path:
    """The scene's FMU by the wheel's own generic one, unpacked."""
    generic = folder / "laconic" / "_built" / "fmu" / "Laconic_fmi2.fmu"
    content = make.content_of(scene, scene.name, "for a test", make.start_values(scene))
    archive.scene_fmu(generic, make.DESCRIPTION, content, folder / "robot.fmu", archive.Variant(2), None)
    zipfile.ZipFile(folder / "robot.fmu").extractall(folder / "fmu")
    return folder / "fmu"


def bits(value: float) -> str:
    """A double as its 16 digits."""
    return struct.pack(">d", value).hex()


@pytest.mark.parametrize("name", PLATFORMS)
def test_no_wheel_nor_an_fmu_in_it_holds_a_path_of_the_machine_that_made_it(name: str) -> None:
    here = [str(PROJECT).encode(), str(WHEELS.parent).encode(), str(Path.home()).encode() + b"/"]
    wheel = wheel_of(name)
    found = [each for each in wheel.namelist() if any(path in wheel.read(each) for path in here)]
    for fmu in (each for each in wheel.namelist() if each.endswith(".fmu")):
        with zipfile.ZipFile(wheel.open(fmu)) as inside:
            found += [f"{fmu}: {each}" for each in inside.namelist() if any(path in inside.read(each) for path in here)]
    assert found == []


@pytest.mark.parametrize("name", PLATFORMS)
def test_every_wheel_holds_its_platforms_binaries_and_fmus_of_all(name: str) -> None:
    platform, wheel = PLATFORMS[name], wheel_of(name)
    names = wheel.namelist()
    for library in LIBRARIES:
        data = wheel.read(f"laconic/_built/lib/{platform.library.format(library)}")
        assert data.startswith(MAGIC[Path(platform.library).suffix])
    assert all((f"laconic/_built/bin/{each}" in names) == platform.has_node_process for each in PROGRAMS)
    fmu = zipfile.ZipFile(wheel.open("laconic/_built/fmu/Laconic_fmi3.fmu"))
    folders: Sequence[str] = [each.split("/")[1] for each in fmu.namelist() if each.startswith("binaries/")]
    assert set(folders) == {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"}
