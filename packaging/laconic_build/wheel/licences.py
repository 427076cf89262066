"""Licences of what others wrote that was compiled into what a wheel holds, by their files' names in its dist-info."""

from __future__ import annotations

from pathlib import Path

from laconic_fmu.licences import COMPILER_TEXTS, compiler_text, licence_of, ziglang_in


def licences(fmi_headers: Path, wire: Path) -> dict[str, str]:
    """Of what is compiled with our sources."""
    return {"LICENSE-fmi-headers.txt": licence_of(fmi_headers / "fmi3FunctionTypes.h"),
            "LICENSE-cantools.txt": licence_of(wire / "laconic_dbc.c")}


def compiler_licences(python: str) -> dict[str, str]:
    """Of what the compiler adds, by the interpreter that has ziglang: all, as FMUs have binaries of every platform."""
    zig = ziglang_in(Path(python).parents[1])
    return {f"LICENSE-{key}.txt": compiler_text(zig, key) for key in COMPILER_TEXTS}
