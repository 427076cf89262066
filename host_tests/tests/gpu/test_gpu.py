"""A batch on a GPU: the kernel's text has the scalar core's bits, and a device rounds every operation by itself.

No GPU is needed: the text is compiled for the host too, and NVRTC makes a device's code without a device.
"""

from __future__ import annotations

import ctypes
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from host_device import HostDevice

import laconic
from laconic.cli.main import run
from laconic.core import load
from laconic.gpu import Gpu, compiler, driver, text
from laconic.gpu.lanes import BY_NAME

PAGE = (text.CORE.parent / "docs/gpu.md").read_text(encoding="utf-8")
needs_compiler = pytest.mark.skipif(shutil.which("g++") is None, reason="no g++ here")
needs_nvrtc = pytest.mark.skipif(not compiler.is_there(), reason="NVRTC is not installed")


def robot(damping_Nms: float, real: str) -> laconic.Vehicle:
    wheels = [{"kind": "omni", "x_m": 0.125 * np.cos(a), "y_m": 0.125 * np.sin(a), "axle_rad": a}
              for a in np.radians([60, 180, 300])]
    return laconic.Vehicle({"mass_kg": 8.0, "yaw_inertia_kgm2": 0.0625, "wheel_radius_m": 0.04, "wheel": wheels,
                            "wheel_inertia_kgm2": 0.0019, "motor_gain_Nm_per_V": 0.138,
                            "motor_damping_Nms": damping_Nms}, real)


def population(method: str, real: str) -> laconic.Batch:
    """Lanes of two kinds, slowly and fast damped, some with forces fixed in the world, one whose voltage is none."""
    kinds = [robot(damping, real) for damping in ((0.1, 0.2) if method == "rk4" else (0.1, 50.0))]
    batch = laconic.Batch(kinds, method=method, step_s=0.01, kind_of=np.arange(21) % 2)
    batch.voltage_V = np.random.default_rng(3).uniform(-6, 6, batch.voltage_V.shape)
    batch.world_force_N[0, ::4] = 2.0
    batch.body_moment_Nm[3] = 0.1
    batch.voltage_V[1, 9] = np.nan
    for lane in range(21):
        batch.start(lane, x_m=lane, heading_rad=0.4 * lane, nu_rad_per_s=(1.0, -2.0, 400.0 if lane == 5 else 3.0))
    return batch


def bits(batch: laconic.Batch) -> list[bytes]:
    return [bytes(batch.core.ffi.buffer(batch.state(lane))) for lane in range(batch.lane_count)]


@needs_compiler
@pytest.mark.parametrize("method, real, kernels", [("rk4", "double", 1), ("auto", "single", 2)])
def test_the_kernels_text_has_the_bits_and_refusals_of_the_batch(method: str, real: str, kernels: int, tmp_path: Path):
    device, on_host, on_device = HostDevice(tmp_path), population(method, real), population(method, real)
    with Gpu(on_device, device) as gpu:
        for steps in (1, 30):
            assert gpu.run(steps) == on_host.run(steps) > 0
            assert bits(on_device) == bits(on_host)
            assert on_device.status.tolist() == on_host.status.tolist()
            assert on_device.missed.tolist() == on_host.missed.tolist()
            np.testing.assert_array_equal(on_device.heading_rad, on_host.heading_rad)
        assert len(device.kernels) == kernels
        gpu.step(4)  # stays on the device until it is fetched
        assert bits(on_device) == bits(on_host)
        on_host.run(4)
        gpu.fetch()
        assert bits(on_device) == bits(on_host)
    assert device.memory == {}


def test_kernels_are_numbered_as_the_lanes_methods_are():
    header = (text.CORE / "batch/lanes_width.h").read_text(encoding="utf-8")
    names = re.findall(r"^    LANES_(\w+),", header, re.MULTILINE)
    assert [name.lower().replace("_", "-") for name in names] == list(BY_NAME)


def test_the_text_is_the_cores_own_each_file_once():
    found = text.kernel_text()
    for name in ("src/rk4.c", "src/step_internals.h", "include/laconic/laconic.h", "batch/batch_run.c"):
        head = (text.CORE / name).read_text(encoding="utf-8").split("*/")[0]
        assert found.count(head) == 1, name
    assert re.findall(r'#include ["<]', found) == []


def test_the_text_lies_in_the_folders_that_a_wheel_holds():
    seen: set[Path] = set()
    text._with_includes(text.KERNEL, seen)
    contents = (text.CORE.parent / "packages/python/laconic_wheel/contents.py").read_text(encoding="utf-8")
    for folder in {path.parent.relative_to(text.CORE.parent).as_posix() for path in seen}:
        assert f'"{folder}"' in contents


@needs_compiler
def test_memory_is_given_back_when_there_is_too_little_and_nothing_is_stepped_after(tmp_path: Path):
    class Small(HostDevice):
        def allocate(self, size: int) -> int:
            if len(self.memory) == 2:
                raise laconic.BadInput("out of memory")
            return super().allocate(size)

    small, device = Small(tmp_path), HostDevice(tmp_path)
    with pytest.raises(laconic.BadInput, match="out of memory"):
        Gpu(population("rk4", "double"), small)
    assert small.memory == {}
    gpu = Gpu(population("rk4", "double"), device)
    gpu.close()
    with pytest.raises(laconic.BadInput, match="gpu: is closed"):
        gpu.run()


@needs_nvrtc
def test_a_device_that_the_compiler_does_not_know_is_one_line():
    with pytest.raises(laconic.BadInput, match="NVRTC does not compile for sm_11"):
        compiler.compiled(0, load("double"), "sm_11")


@needs_nvrtc
@pytest.mark.parametrize("real, architecture, method", [
    *(("double", "compute_80", method) for method in range(8)),
    *(("single", "compute_90", method) for method in range(6))])
def test_every_operation_on_the_device_is_rounded_by_itself_to_nearest(real: str, architecture: str, method: int):
    ptx = compiler.compiled(method, load(real), architecture).decode()
    word = "f64" if real == "double" else "f32"
    found = set(re.findall(rf"\b([a-z0-9]+(?:\.[a-z0-9]+)*\.{word})\b", ptx))
    rounded = {f"{operation}.rn.{word}" for operation in ("add", "sub", "mul")}
    assert rounded < found
    rounds = re.compile(r"(add|sub|mul|div|rcp|sqrt|fma|mad|ex2|lg2|sin|cos|rsqrt)\.")
    arithmetic = {each for each in found if rounds.match(each)}
    assert arithmetic <= rounded | {f"div.rn.{word}", f"rcp.rn.{word}"}
    assert "ftz" not in ptx and ".approx" not in ptx and "fma." not in ptx


@needs_nvrtc
@pytest.mark.parametrize("architecture", ["sm_80", "sm_90"])
def test_machine_code_is_made_for_devices_that_are_not_there(architecture: str):
    assert compiler.compiled(BY_NAME["rk4"], load("double"), architecture)[:4] == b"\x7fELF"


class FakeDriver:
    """The driver's functions, as far as they can be without a device: what was called, with the numbers behind it."""

    def __init__(self) -> None:
        self.calls: list[tuple] = []
        self.refuses = ""

    def __getattr__(self, name: str):
        def call(*given) -> int:
            if name in ("cuMemAlloc_v2", "cuDeviceGetAttribute"):
                given[0]._obj.value = 4096 if name == "cuMemAlloc_v2" else {75: 9, 76: 0}[given[1]]
            if name == "cuGetErrorString":
                given[1]._obj.value = b"out of memory"
            if name == "cuLaunchKernel":
                pointers = given[9]
                given = (*given[1:7], ctypes.cast(pointers[0], ctypes.POINTER(ctypes.c_uint64))[0],
                         ctypes.cast(pointers[1], ctypes.POINTER(ctypes.c_int32))[0])
            self.calls.append((name, given))
            return int(name == self.refuses)
        return call


def test_the_driver_is_given_blocks_that_cover_the_lanes_and_the_arguments_numbers(monkeypatch: pytest.MonkeyPatch):
    fake = FakeDriver()
    monkeypatch.setattr(driver, "_driver", lambda: fake)
    asked = []
    monkeypatch.setattr(driver, "compiled", lambda *given: asked.append(given) or b"code")
    device, core = driver.CudaDevice(), load("double")
    assert device.allocate(10) == 4096
    for _ in range(2):
        device.launch(3, core, 129, (ctypes.c_uint64(2**40), ctypes.c_int32(-7)))
    assert asked == [(3, core, "sm_90")]
    launched = [given for name, given in fake.calls if name == "cuLaunchKernel"]
    assert launched == [(2, 1, 1, 128, 1, 1, 2**40, -7)] * 2
    assert fake.calls[-1][0] == "cuCtxSynchronize"
    fake.refuses = "cuMemAlloc_v2"
    with pytest.raises(laconic.BadInput, match="refuses cuMemAlloc_v2: out of memory"):
        device.allocate(10)


def test_no_driver_and_no_device_are_one_line_each(monkeypatch: pytest.MonkeyPatch):
    def missing(_: str) -> None:
        raise OSError

    none = SimpleNamespace(cuInit=lambda _: 0, cuDeviceGetCount=lambda _: 0)
    for library, message in ((missing, "libcuda.so.1 is not there"), (lambda _: none, "the driver finds none")):
        driver._driver.cache_clear()
        monkeypatch.setattr(driver.ctypes, "CDLL", library)
        with pytest.raises(laconic.BadInput, match=message):
            driver.CudaDevice()


@needs_compiler
def test_the_pages_program_steps_a_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                         capsys: pytest.CaptureFixture[str]):
    program = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0]
    program = program.replace("1_000_000", "5").replace("steps=1000", "steps=10")
    monkeypatch.setattr("laconic.gpu.lanes.CudaDevice", lambda: HostDevice(tmp_path))
    exec(program, {})
    plant = laconic.Vehicle.of(laconic.read_scene("robotino2")).plant("rk4", 0.001)
    plant.run({"voltage_V": [-5.0, 0.0, 5.0]}, steps=10)
    assert capsys.readouterr().out == f"{plant.pose.x_m:.4f} m\n"


@pytest.mark.parametrize("more", [[], ["--json"]])
def test_without_a_gpu_the_pages_command_says_so_in_one_line(more, monkeypatch: pytest.MonkeyPatch,
                                                       capsys: pytest.CaptureFixture[str]):
    def none() -> None:
        raise laconic.BadInput("no GPU can be used here: the driver finds none")

    monkeypatch.setattr(driver, "_driver", none)
    words = re.findall(r"^    laconic (.*)$", PAGE, re.MULTILINE)[0].split()
    assert run([*words, *more]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err == "laconic: no GPU can be used here: the driver finds none\n"


def test_without_its_compiler_one_line_names_the_package(monkeypatch: pytest.MonkeyPatch):
    compiler._library.cache_clear()
    monkeypatch.setattr(compiler.ctypes, "CDLL", lambda _: (_ for _ in ()).throw(OSError()))
    with pytest.raises(laconic.BadInput, match="nvidia-cuda-nvrtc"):
        compiler.compiled(0, load("double"), "compute_70")
    assert not compiler.is_there()
