"""The kernel's text: the core's own files, one after the other as they include each other."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from laconic.paths import SOURCE_DIR

CORE = SOURCE_DIR / "core_c"
KERNEL = CORE / "batch/gpu_run.cu"
INCLUDE = re.compile(r'^#include "([^"]+)".*\n', re.MULTILINE)
STANDARD = re.compile(r"^#include <(?:float|stdbool|stddef|stdint)\.h>\n", re.MULTILINE)
NUMBERS_OF_C = """\
typedef signed char int8_t; typedef unsigned char uint8_t; typedef int int32_t; typedef unsigned int uint32_t;
typedef long long int64_t; typedef unsigned long long uint64_t; typedef unsigned long long uintptr_t;
#define NULL 0
#define INT64_MIN (-9223372036854775807LL - 1)
#define UINT32_C(x) x##U
#define UINT64_C(x) x##ULL
#define DBL_MAX 1.7976931348623157e308
#define DBL_MIN 2.2250738585072014e-308
#define DBL_EPSILON 2.220446049250313e-16
#define DBL_MANT_DIG 53
#define FLT_MAX 3.402823466e38F
#define FLT_MIN 1.175494351e-38F
#define FLT_EPSILON 1.1920929e-7F
"""
"""What the core needs of <stdint.h>, <stddef.h> and <float.h>, which the compiler for devices does not bring."""


@cache
def kernel_text() -> str:
    """All of it; without the headers of C, which NUMBERS_OF_C stands in for."""
    return STANDARD.sub("", _with_includes(KERNEL, set()))


def _with_includes(file: Path, seen: set[Path]) -> str:
    """A file with what it includes in place, each once."""
    if file in seen:
        return ""
    seen.add(file)
    return INCLUDE.sub(lambda found: _with_includes(_found(found[1], file), seen), file.read_text(encoding="utf-8"))


def _found(name: str, included_by: Path) -> Path:
    beside = (included_by.parent / name).resolve()
    return beside if beside.exists() else CORE / "include" / name
