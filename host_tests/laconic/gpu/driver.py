"""A device of NVIDIA's by the driver's own interface, libcuda: memory, copies, and kernels that are launched."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.gpu.compiler import compiled

THREADS = 128  # of a block
MAJOR, MINOR, NAME = 75, 76, 100  # CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_…; length of a name


@cache
def _driver() -> ctypes.CDLL:
    try:
        driver = ctypes.CDLL("libcuda.so.1")
    except OSError:
        raise BadInput("no GPU can be used here: the driver's library libcuda.so.1 is not there") from None
    count = ctypes.c_int()
    if driver.cuInit(0) or driver.cuDeviceGetCount(ctypes.byref(count)) or count.value < 1:
        raise BadInput("no GPU can be used here: the driver finds none")
    return driver


class CudaDevice:
    """The first device. BadInput where there is none, and for what its driver refuses."""

    def __init__(self) -> None:
        self._driver, self._number, self._context = _driver(), ctypes.c_int(), ctypes.c_void_p()
        self._kernels: dict[tuple[int, Core], Any] = {}
        self._call("cuDeviceGet", ctypes.byref(self._number), 0)
        self._call("cuDevicePrimaryCtxRetain", ctypes.byref(self._context), self._number)

    def _call(self, name: str, *arguments: Any) -> None:
        if self._context:
            self._driver.cuCtxSetCurrent(self._context)  # of the thread that calls
        if failed := getattr(self._driver, name)(*arguments):
            text = ctypes.c_char_p()
            self._driver.cuGetErrorString(failed, ctypes.byref(text))
            raise BadInput(f"the GPU's driver refuses {name}: {(text.value or b'unknown error').decode()}; fewer lanes "
                           "need less memory, and another driver may know this device")

    @property
    def name(self) -> str:
        """What its maker calls it."""
        room = ctypes.create_string_buffer(NAME)
        self._call("cuDeviceGetName", room, NAME, self._number)
        return room.value.decode()

    @property
    def architecture(self) -> str:
        """For the compiler: sm_90."""
        parts = [ctypes.c_int(), ctypes.c_int()]
        for part, attribute in zip(parts, (MAJOR, MINOR), strict=True):
            self._call("cuDeviceGetAttribute", ctypes.byref(part), attribute, self._number)
        return f"sm_{parts[0].value}{parts[1].value}"

    def allocate(self, size: int) -> int:
        """Bytes of its memory."""
        found = ctypes.c_uint64()
        self._call("cuMemAlloc_v2", ctypes.byref(found), ctypes.c_size_t(max(size, 1)))
        return found.value

    def free(self, address: int) -> None:
        """Gives memory back."""
        self._call("cuMemFree_v2", ctypes.c_uint64(address))

    def send(self, address: int, data: np.ndarray) -> None:
        """To its memory."""
        self._call("cuMemcpyHtoD_v2", ctypes.c_uint64(address), ctypes.c_void_p(data.ctypes.data),
                   ctypes.c_size_t(data.nbytes))

    def fetch(self, data: np.ndarray, address: int) -> None:
        """From its memory, when all that was launched is done."""
        self._call("cuMemcpyDtoH_v2", ctypes.c_void_p(data.ctypes.data), ctypes.c_uint64(address),
                   ctypes.c_size_t(data.nbytes))

    def launch(self, method: int, core: Core, lanes: int, arguments: tuple[Any, ...]) -> None:
        """The kernel of a method over so many lanes, and waits for its end; arguments are numbers of ctypes."""
        if (kernel := self._kernels.get((method, core))) is None:
            kernel = self._kernels[method, core] = self._load(method, core)
        pointers = (ctypes.c_void_p * len(arguments))(*(ctypes.addressof(each) for each in arguments))
        self._call("cuLaunchKernel", kernel, (lanes + THREADS - 1) // THREADS, 1, 1, THREADS, 1, 1, 0, None, pointers,
                   None)
        self._call("cuCtxSynchronize")

    def _load(self, method: int, core: Core) -> ctypes.c_void_p:
        module, kernel = ctypes.c_void_p(), ctypes.c_void_p()
        self._call("cuModuleLoadData", ctypes.byref(module), compiled(method, core, self.architecture))
        self._call("cuModuleGetFunction", ctypes.byref(kernel), module, b"laconic_gpu_run")
        return kernel
