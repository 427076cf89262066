"""The lanes of a Batch on a device: copies of its memory, and the kernels of the methods that its kinds have."""

from __future__ import annotations

import ctypes
from typing import Any, Protocol

import numpy as np

from laconic.batch import Batch
from laconic.core import Core
from laconic.core.given import step_count
from laconic.errors import BadInput
from laconic.gpu.compiler import STEPS
from laconic.gpu.driver import CudaDevice

BY_NAME = {step.removesuffix("_step").replace("_", "-"): number for number, step in enumerate(STEPS)}


class Device(Protocol):
    """What runs kernels; CudaDevice is one."""

    def allocate(self, size: int) -> int: ...
    def free(self, address: int) -> None: ...
    def send(self, address: int, data: np.ndarray) -> None: ...
    def fetch(self, data: np.ndarray, address: int) -> None: ...
    def launch(self, method: int, core: Core, lanes: int, arguments: tuple[Any, ...]) -> None: ...


class Gpu:
    """Steps a Batch on a device, with the bits, statuses and missed steps that `batch.run` gives it.

    `run` sends the batch's numbers, steps, and fetches them. A program that steps many times without looking calls
    `send`, `step` … `step`, `fetch` itself: in between the batch's own arrays stay as they were, and what is written
    into them is lost by `fetch`. Memory is given back by `close` or at the end of a `with`. A batch of width_bytes=1
    has the least to copy. BadInput where there is no device or no compiler for it.
    """

    def __init__(self, batch: Batch, device: Device | None = None):
        self.batch, self.device = batch, device or CudaDevice()
        ffi = batch.core.ffi
        self._methods = sorted({_method_of(batch.core, kind) for kind in batch._kinds})
        self._kinds = np.frombuffer(ffi.buffer(batch._kinds), np.uint8)
        self._there = batch._memory.ctypes.data
        sizes = (len(batch._memory), len(self._kinds), ffi.sizeof("laconic_batch"))
        self._memory: list[int] = []
        try:
            for size in sizes:
                self._memory.append(self.device.allocate(size))
        except BadInput:
            self.close()
            raise
        self._copy = self._batch_there(*self._memory[:2])

    def _batch_there(self, numbers: int, kinds: int) -> np.ndarray:
        """The laconic_batch whose pointers are those of the device, as bytes."""
        ffi, c = self.batch.core.ffi, self.batch.c
        copy = ffi.new("laconic_batch *", c[0])
        for name in ("rows", "status", "missed", "kind_of", "order", "slot_of", "blocks"):
            place = int(ffi.cast("uintptr_t", getattr(c, name))) - self._there
            setattr(copy, name, ffi.cast(ffi.typeof(getattr(c, name)), numbers + place))
        copy.kinds, copy.width = ffi.cast("laconic_batch_kind *", kinds), ffi.NULL
        return np.frombuffer(bytes(ffi.buffer(copy)), np.uint8)

    def __enter__(self) -> Gpu:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Gives the device's memory back; nothing can be stepped afterwards."""
        while self._memory:
            self.device.free(self._memory.pop())

    def _places(self) -> list[int]:
        if not self._memory:
            raise BadInput("gpu: is closed, its memory is given back; make another of the batch")
        return self._memory

    def send(self) -> None:
        """States, inputs and kinds of the batch, as they are now."""
        for address, part in zip(self._places(), (self.batch._memory, self._kinds, self._copy), strict=True):
            self.device.send(address, part)

    def step(self, steps: int = 1) -> None:
        """Steps of all lanes on the device, which stop where one is refused."""
        numbers, _, batch = self._places()
        width = max(1, self.batch.width_bytes // self.batch.core.dtype.itemsize)
        arguments = (ctypes.c_uint64(batch), ctypes.c_uint64(numbers), ctypes.c_uint64(self._there),
                     ctypes.c_int32(width), ctypes.c_uint64(step_count("steps", steps)))
        for method in self._methods:
            self.device.launch(method, self.batch.core, self.batch.lane_count, arguments)

    def fetch(self) -> int:
        """States and statuses into the batch; returns how many lanes the last `step` refused."""
        self.device.fetch(self.batch._memory, self._places()[0])
        self.batch._is_observed = False
        return int(np.count_nonzero(self.batch.status))

    def run(self, steps: int = 1) -> int:
        """send, step, fetch: as `Batch.run`."""
        self.send()
        self.step(steps)
        return self.fetch()


def _method_of(core: Core, kind: Any) -> int:
    """By the numbers of lanes_method."""
    name = core.text(kind.integrator.method.name)
    return BY_NAME[f"auto-{'fast' if kind.integrator.stiff else 'slow'}" if name == "auto" else name]
