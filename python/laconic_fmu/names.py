"""Names of an FMU's own for everything that its sources define: sources of several FMUs link into one program.

FMI requires a prefix for its own functions in source FMUs; the other functions and tables need one as well. The header
made here renames both. Each file of sources/ includes it first.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath

HEADER = "fmu_names.h"

DEFINED = re.compile(r"^(?!static\b|typedef\b|extern\b|return\b|else\b|[A-Z_]+[ (]|#|/|\*|\}|\s)"
                     r"(?:\w+ (?:\w+ |\*)*\*?([a-z]\w*)(?=\(|\[[^;]*\] *=| =|;)|\w+\(([a-z]\w*)\)\()", re.MULTILINE)
"""A function or table at the left margin of a source file, where this project's layout has nothing else of the kind."""
BY_MACRO = re.compile(r"^[A-Z_]+\(((?:fmu|laconic)_\w+)", re.MULTILINE)
"""One that a macro of the file defines."""
CHECKED = re.compile(r"\blaconic_\w*built_with(?:out)?_\w+")
"""Functions whose names state definitions (laconic/build.h); one that ends in _ is continued by a number."""
NUMBER = re.compile(r"^# *define (LACONIC_\w+) (\d+)\b", re.MULTILINE)
OF_FMI = re.compile(r"fmi[23][A-Z]")


def _checked(text: str, numbers: Iterable[tuple[str, str]]) -> set[str]:
    found = set(CHECKED.findall(text))
    whole = {name for name in found if not name.endswith("_")}
    return whole | {f"{begun}{value}" for begun in found - whole
                    for setting, value in numbers if begun.endswith(f"_{setting}_")}


def defined_names(files: Mapping[str, str]) -> list[str]:
    """The external names that the texts of .c files define, without FMI's own, in the order of the alphabet."""
    numbers = {pair for text in files.values() for pair in NUMBER.findall(text)}
    names: set[str] = set()
    for name, text in files.items():
        names |= _checked(text, numbers)
        if name.endswith(".c"):
            names |= {one or other for one, other in DEFINED.findall(text) if not OF_FMI.match(one)}
            names |= set(BY_MACRO.findall(text))
    return sorted(names)


def names_header(identifier: str, version: int, names: Iterable[str]) -> str:
    """The text of the header. Names differ between the FMI versions of a model as well."""
    guard, prefix = "LACONIC_FMU_NAMES_H", f"FMI{version}_FUNCTION_PREFIX"
    return "\n".join([
        "/* Names of this FMU's own, so that the sources of several FMUs can be linked into one program. Made when it",
        f" * is packed. The functions of FMI are {identifier}_fmi{version}…, except in a shared library, which defines",
        f" * FMI{version}_OVERRIDE_FUNCTION_PREFIX or, by CMake, {identifier}_EXPORTS. */",
        f"#ifndef {guard}", f"#define {guard}", "",
        f"#if !defined {prefix} && !defined FMI{version}_OVERRIDE_FUNCTION_PREFIX && !defined {identifier}_EXPORTS",
        f"#define {prefix} {identifier}_",
        "#endif", "",
        "#ifndef LACONIC_IN_CORE",
        "#define LACONIC_IN_CORE /* all is compiled alike: nothing to check (laconic/build.h) */",
        "#endif", "",
        *(f"#define {name} {identifier}_{version}_{name}" for name in names),
        "", "#endif", ""])


def with_own_names(parts: Mapping[str, bytes], identifier: str, version: int) -> dict[str, bytes]:
    """The files of sources/ by their names there, each .c file with the header of names first, and the header."""
    texts = {name: data.decode("utf-8") for name, data in parts.items() if name.endswith((".c", ".h"))}
    renamed = dict(parts)
    for name, text in texts.items():
        if name.endswith(".c"):
            up = "../" * (len(PurePosixPath(name).parts) - 1)
            renamed[name] = f'#include "{up}{HEADER}"\n{text}'.encode()
    renamed[HEADER] = names_header(identifier, version, defined_names(texts)).encode("utf-8")
    return renamed
