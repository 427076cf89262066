"""How many vehicles a GPU steps in a second: `laconic benchmark gpu`."""

from __future__ import annotations

import time
from typing import Any

from laconic.batch import Batch
from laconic.benchmark.many.race import task_of
from laconic.benchmark.many.task import Task
from laconic.core import Vehicle
from laconic.errors import ResultFails
from laconic.gpu.driver import CudaDevice
from laconic.gpu.lanes import Gpu
from laconic.progress import progress_bar

PUBLIC = ("for comparison: a published simulator of quadrotors states 914 million steps/s on one RTX 4090; it computes "
          "another vehicle, without these bits")
METHODS, REALS, STEPS, CHECKED = ("rk4", "auto"), ("double", "single"), 1000, 4096


def rows(lanes: int, rounds: int) -> tuple[str, list[dict[str, Any]]]:
    """The device's name; and for methods and scalar types vehicle-steps a second, without copies to the device and
    back. Lanes are first compared with the batch's; ResultFails where a bit differs."""
    device, found = CudaDevice(), []
    with progress_bar("GPU", len(METHODS) * len(REALS)) as advance:
        for method in METHODS:
            for real in REALS:
                advance(0, f"{method}, {real}")
                check(device, method, real)
                with Gpu(_batch(task_of(lanes), method, real), device) as gpu:
                    seconds = _least(gpu, rounds)
                found.append({"who": method, "real": real, "million_steps_per_s": 1e-6 * lanes * STEPS / seconds,
                              "ns_per_step": 1e9 * seconds / (lanes * STEPS)})
                advance()
    return device.name, found


def check(device: Any, method: str, real: str, lanes: int = CHECKED) -> None:
    """The same bits as on the processor."""
    ours, theirs = (_batch(task_of(lanes), method, real) for _ in range(2))
    ours.run(100)
    with Gpu(theirs, device) as gpu:
        gpu.run(100)
    for lane in range(lanes):
        if bytes(ours.core.ffi.buffer(ours.state(lane))) != bytes(ours.core.ffi.buffer(theirs.state(lane))):
            raise ResultFails(f"{method}, {real}: lane {lane} has other bits on the GPU; nothing was timed")


def _batch(task: Task, method: str, real: str) -> Batch:
    batch = Batch(Vehicle(task.scene.vehicle, real), task.lanes, method, task.step_s)
    batch.voltage_V = task.voltages_V
    return batch


def _least(gpu: Gpu, rounds: int) -> float:
    """Seconds of a run of STEPS, which ends when the device has done it."""
    gpu.send()
    gpu.step(1)  # loads the kernel
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        gpu.step(STEPS)
        best = min(best, time.perf_counter() - start)
    return best
