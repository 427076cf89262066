"""A device that is none: the kernel's text compiled for the host by g++, its threads one after the other."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.gpu.compiler import definitions
from laconic.gpu.text import kernel_text

SHIM = """\
#include <float.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
struct three { unsigned x; };
static three blockIdx, blockDim, threadIdx;
#define __global__
"""
ALL_THREADS = """
extern "C" __attribute__((visibility("default"))) void all_threads(int32_t block, laconic_batch *batch,
    unsigned char *here, const unsigned char *there, int32_t width, uint64_t steps) {
    blockDim.x = (unsigned)block;
    for (blockIdx.x = 0; (int32_t)(blockIdx.x * blockDim.x) < batch->shape.lane_count; blockIdx.x++)
        for (threadIdx.x = 0; threadIdx.x < blockDim.x; threadIdx.x++)
            laconic_gpu_run(batch, here, there, width, steps);
}
"""
COMPILE = ("g++", "-x", "c++", "-std=c++11", "-O0", "-ffp-contract=off", "-w", "-fPIC", "-shared",
           "-fvisibility=hidden", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections,-z,defs")


class HostDevice:
    """Memory of its own, so that what is not sent or fetched shows."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.memory: dict[int, np.ndarray] = {}
        self.kernels: dict[tuple[int, Core], ctypes.CDLL] = {}

    def allocate(self, size: int) -> int:
        room = np.full(size, 0xA5, np.uint8)
        self.memory[room.ctypes.data] = room
        return room.ctypes.data

    def free(self, address: int) -> None:
        del self.memory[address]

    def send(self, address: int, data: np.ndarray) -> None:
        ctypes.memmove(address, data.ctypes.data, data.nbytes)

    def fetch(self, data: np.ndarray, address: int) -> None:
        ctypes.memmove(data.ctypes.data, address, data.nbytes)

    def launch(self, method: int, core: Core, lanes: int, arguments: tuple[Any, ...]) -> None:
        if (method, core) not in self.kernels:
            self.kernels[method, core] = self.compiled(method, core)
        self.kernels[method, core].all_threads(ctypes.c_int32(8), *arguments)

    def compiled(self, method: int, core: Core) -> ctypes.CDLL:
        source = self.folder / f"kernel_{method}_{core.real}.cc"
        library = source.with_suffix(".so")
        source.write_text(SHIM + kernel_text() + ALL_THREADS, encoding="utf-8")
        subprocess.run([*COMPILE, *definitions(method, core), str(source), "-o", str(library)], check=True)
        return ctypes.CDLL(str(library))
