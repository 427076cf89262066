"""NVRTC, the compiler for NVIDIA's devices as a library: the kernel's text to machine code, when the program runs."""

from __future__ import annotations

import ctypes
import importlib.util
from functools import cache
from pathlib import Path

from laconic.core import Core
from laconic.errors import BadInput
from laconic.gpu.text import NUMBERS_OF_C, kernel_text

STEPS = ("rk4_step", "exponential_kahan_step", "exponential_kahan_4_step", "exact_flow_step", "exact_flow_4_step",
         "taylor_8_step", "exponential_gauss_8_step", "auto_slow_step", "auto_fast_step")
"""The step functions, by the numbers of lanes_method in core_c/batch/lanes_width.h."""

OPTIONS = ("--std=c++17", "--device-as-default-execution-space", "--fmad=false", "--prec-div=true", "--prec-sqrt=true",
           "--ftz=false")
"""Every operation is rounded by itself, to nearest, as in the core for a processor."""

MISSING = ("a GPU needs NVRTC, NVIDIA's compiler as a library; it comes with CUDA or with the Python package "
           "nvidia-cuda-nvrtc (docs/gpu.md)")


@cache
def _library() -> ctypes.CDLL:
    for path in [*_in_packages(), "libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12"]:
        try:
            return ctypes.CDLL(str(path))
        except OSError:
            continue
    raise BadInput(MISSING)


def _in_packages() -> list[Path]:
    """Where the Python package has it."""
    spec = importlib.util.find_spec("nvidia")
    roots = [Path(root) for root in (spec.submodule_search_locations or [])] if spec else []
    return [path for root in roots for path in sorted(root.glob("*/lib/libnvrtc.so.*"))]


def is_there() -> bool:
    """Whether NVRTC can be loaded."""
    try:
        _library()
    except BadInput:
        return False
    return True


def definitions(method: int, core: Core) -> list[str]:
    """What the text is compiled with for a method, by its number, and a scalar type."""
    found = [f"-DLACONIC_GPU_METHOD={method}", f"-DLACONIC_GPU_STEP={STEPS[method]}", "-DLACONIC_WITH_PREPARE=0",
             f"-DLACONIC_GPU_KIND_BYTES={core.ffi.sizeof('laconic_batch_kind')}"]
    return [*found, "-DLACONIC_SINGLE"] if core.real == "single" else found


@cache
def compiled(method: int, core: Core, architecture: str) -> bytes:
    """The kernel of a method: for `compute_80` … as PTX, for `sm_80` … as machine code."""
    nvrtc, program = _library(), ctypes.c_void_p()
    text = (NUMBERS_OF_C + kernel_text()).encode()
    options = [*OPTIONS, f"--gpu-architecture={architecture}", *definitions(method, core)]
    nvrtc.nvrtcCreateProgram(ctypes.byref(program), text, b"gpu_run.cu", 0, None, None)
    given = (ctypes.c_char_p * len(options))(*(option.encode() for option in options))
    failed = nvrtc.nvrtcCompileProgram(program, len(options), given)
    try:
        if failed:
            log = _take(nvrtc, program, "ProgramLog").rstrip(b"\0").decode(errors="replace")
            raise BadInput(f"NVRTC does not compile for {architecture}: {log or 'it does not know this device'}; try "
                           "another version of nvidia-cuda-nvrtc")
        return _take(nvrtc, program, "PTX" if architecture.startswith("compute") else "CUBIN")
    finally:
        nvrtc.nvrtcDestroyProgram(ctypes.byref(program))


def _take(nvrtc: ctypes.CDLL, program: ctypes.c_void_p, what: str) -> bytes:
    size = ctypes.c_size_t()
    getattr(nvrtc, f"nvrtcGet{what}Size")(program, ctypes.byref(size))
    room = ctypes.create_string_buffer(size.value)
    getattr(nvrtc, f"nvrtcGet{what}")(program, room)
    return room.raw
