"""A small FMI importer for tests: every function as it is, statuses and log lines included."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import cffi
import fmpy
import lark

from laconic.base.paths import build_dir, built

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3
TYPES_3 = {"Float64": "Float64", "Int32": "Int32", "UInt64": "UInt64", "Int64": "Int64", "Enumeration": "Int64",
           "Boolean": "Boolean"}
TYPES_2 = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"}
C_TYPES = {"Real": "double", "Integer": "int", "Float64": "double", "Int32": "int32_t", "UInt64": "uint64_t",
           "Int64": "int64_t"}
NEEDED = ("modelDescription.xml", "binaries/", "resources/", "extra/")


class KnownNames(lark.Lark):
    """FMPy checks each variable's name by a slow grammar, in every FMU anew: a name found legal is not read again, nor
    is one that differs by its index alone."""

    legal: ClassVar[set[tuple[str, str]]] = set()

    def parse(self, text: str, *_: Any, **__: Any) -> None:
        known = self.source_grammar, re.sub(r"\[\d+\]", "[0]", text)
        if known not in self.legal:
            super().parse(text)
            self.legal.add(known)


lark.Lark = KnownNames  # FMPy imports it when it checks names


@functools.cache
def interface(version: int) -> cffi.FFI:
    """The declarations of one FMI version."""
    headers = build_dir() / "parts" / "fmi"
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler, "the tests need the C compiler that built the FMUs"
    export = f"-DFMI{version}_Export="
    with tempfile.TemporaryDirectory() as bare:
        for name in ("stdlib", "stddef", "stdint", "stdbool"):
            (Path(bare) / f"{name}.h").touch()
        text = subprocess.run(
            [compiler, "-E", "-P", "-nostdinc", export, "-I", str(headers), "-I", bare, "-x", "c", "-"],
            input=f'#include "fmi{version}Functions.h"\n', capture_output=True, text=True, check=True).stdout
    ffi = cffi.FFI()
    ffi.cdef(re.sub(r"#pragma.*|__attribute__ *\(\(.*?\)\)+|extern \"C\"", "", text.replace("()", "(void)")))
    return ffi


@dataclass
class Unpacked:
    """An FMU that instances share, as they do in an importer: its files, its description, its variables by name."""

    place: tempfile.TemporaryDirectory[str]
    description: Any

    @property
    def folder(self) -> Path:
        """Where its files are."""
        return Path(self.place.name)

    @functools.cached_property
    def variables(self) -> dict[str, Any]:
        """Its variables."""
        return {variable.name: variable for variable in self.description.modelVariables}

    @functools.cached_property
    def elements(self) -> dict[str, list[str]]:
        """By the name of an array, "der(x)" for "der(x[1])", the names of its elements."""
        found: dict[str, list[str]] = {}
        for name in self.variables:
            found.setdefault(re.sub(r"\[[^[]*\](?=\)?$)", "", name), []).append(name)
        return found


_unpacked: dict[tuple[Path, int, int], Unpacked] = {}


def unpacked(fmu: Path) -> Unpacked:
    """The FMU, unpacked once."""
    about = fmu.stat()
    key = (fmu, about.st_mtime_ns, about.st_size)
    if key not in _unpacked:
        folder = tempfile.TemporaryDirectory()
        with zipfile.ZipFile(fmu) as archive:  # what an importer needs; sources and pictures are five files of six
            archive.extractall(folder.name, [name for name in archive.namelist() if name.startswith(NEEDED)])
        _unpacked[key] = Unpacked(folder, fmpy.read_model_description(folder.name, validate=False))
    return _unpacked[key]


class Importer:
    """One instance of an FMU. `call("DoStep", …)` calls fmi2DoStep or fmi3DoStep and returns its status."""

    def __init__(self, fmu: Path, kind: str = "CoSimulation", *, logging: bool = False, event_mode: bool = False,
                 early_return: bool = False, update: Any = None, token: str | None = "", name: str | None = "vehicle",
                 resources: Path | None = None, intermediate: Sequence[int] | None = ()):
        self.fmu = fmu
        shared = unpacked(fmu)
        self.folder, self.description, self.variables = shared.folder, shared.description, shared.variables
        self._elements = shared.elements
        self.version = 2 if self.description.fmiVersion == "2.0" else 3
        self.ffi = interface(self.version)
        platform = "linux64" if self.version == 2 else "x86_64-linux"
        identifier = self.description.coSimulation.modelIdentifier
        self.library = self.ffi.dlopen(str(self.folder / "binaries" / platform / f"{identifier}.so"))
        self.log: list[tuple[int, str, str]] = []
        self.kind = kind
        self._keep: list[Any] = []
        if token == "":  # the FMU's own
            token = self.description.guid if self.version == 2 else self.description.instantiationToken
        folder = resources if resources is not None else self.folder / "resources"
        make = self._make_2 if self.version == 2 else self._make_3
        self._intermediate = (self.ffi.NULL, 1) if intermediate is None else (list(intermediate), len(intermediate))
        self.instance = make(self._c_text(name), self._c_text(token), folder, logging, event_mode, early_return, update)

    def _c_text(self, text: str | None) -> Any:
        self._keep.append(self.ffi.NULL if text is None else self.ffi.new("char[]", text.encode()))
        return self._keep[-1]

    def _text(self, pointer: Any) -> str:
        return self.ffi.string(pointer).decode()

    def _make_2(self, name: Any, token: Any, folder: Path, logging: bool, *_: Any) -> Any:
        def logger(_environment: Any, _name: Any, status: int, category: Any, message: Any) -> None:
            self.log.append((int(status), self._text(category), self._text(message)))
        ffi = self.ffi
        plain = ffi.callback("void(void *, const char *, int, const char *, const char *)", logger)
        functions = ffi.new("fmi2CallbackFunctions *", {"logger": ffi.cast("fmi2CallbackLogger", plain)})
        self._keep += [plain, functions]
        kind = 0 if self.kind == "ModelExchange" else 1
        return self.library.fmi2Instantiate(name, kind, token, folder.as_uri().encode(), functions, 0, int(logging))

    def _make_3(self, name: Any, token: Any, folder: Path, logging: bool, event_mode: bool, early_return: bool,
                update: Any) -> Any:
        def logger(_environment: Any, status: int, category: Any, message: Any) -> None:
            self.log.append((int(status), self._text(category), self._text(message)))
        ffi = self.ffi
        callback = ffi.callback("fmi3LogMessageCallback", logger)
        offered = ffi.callback("fmi3IntermediateUpdateCallback", update) if update else ffi.NULL
        self._keep += [callback, offered]
        path = f"{folder}/".encode()
        if self.kind == "ModelExchange":
            return self.library.fmi3InstantiateModelExchange(name, token, path, False, logging, ffi.NULL, callback)
        return self.library.fmi3InstantiateCoSimulation(name, token, path, False, logging, event_mode, early_return,
                                                        *self._intermediate, ffi.NULL, callback, offered)

    def __enter__(self) -> Importer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Frees the instance."""
        if self.instance:
            self.function("FreeInstance")(self.instance)
            self.instance = None
        self.ffi.dlclose(self.library)

    def function(self, name: str) -> Any:
        """fmi2<name> or fmi3<name>."""
        return getattr(self.library, f"fmi{self.version}{name}")

    def call(self, name: str, *arguments: Any) -> int:
        """Calls it on the instance; its status."""
        return int(self.function(name)(self.instance, *arguments))

    def must(self, name: str, *arguments: Any) -> None:
        """Calls it and insists on OK."""
        status = self.call(name, *arguments)
        assert status == OK, f"{name}: status {status}, log: {self.log[-3:]}"

    # ---- life

    def enter_initialization(self, start_s: float = 0.0, stop_s: float | None = None) -> None:
        """From instantiated to initialization mode."""
        stop = (int(stop_s is not None), stop_s or 0.0)
        if self.version == 2:
            self.must("SetupExperiment", 0, 0.0, start_s, *stop)
            self.must("EnterInitializationMode")
        else:
            self.must("EnterInitializationMode", False, 0.0, start_s, bool(stop[0]), stop[1])

    def initialize(self, start_s: float = 0.0, stop_s: float | None = None) -> Importer:
        """From instantiated to step or event mode."""
        self.enter_initialization(start_s, stop_s)
        self.must("ExitInitializationMode")
        return self

    def step(self, at_s: float, step_s: float) -> int:
        """One communication step; its status. FMI 3: its results are in `end`."""
        if self.version == 2:
            return self.call("DoStep", at_s, step_s, 1)
        ffi = self.ffi
        flags, time = ffi.new("bool[3]"), ffi.new("double *")
        status = self.call("DoStep", at_s, step_s, True, flags, flags + 1, flags + 2, time)
        self.end = {"event": flags[0], "terminate": flags[1], "early": flags[2], "time_s": time[0]}
        return status

    # ---- variables

    def references(self, *names: str) -> Any:
        """Value references, as an array."""
        references = [self.variables[name].valueReference for name in names]
        return self.ffi.new(f"fmi{self.version}ValueReference[]", references)

    def _type(self, name: str) -> str:
        return (TYPES_2 if self.version == 2 else TYPES_3)[self.variables[name].type]

    def _array(self, kind: str, values: Sequence[Any] | int) -> Any:
        c_type = C_TYPES.get(kind, "int" if self.version == 2 else "bool")
        return self.ffi.new(f"{c_type}[]", values if isinstance(values, int) else list(values))

    def set(self, name: str, *values: Any) -> int:
        """Sets a variable, or with FMI 2 all its elements; the status."""
        names, kind = self.elements(name)
        array = self._array(self._type(names[0]), values)
        more = (len(values),) if self.version == 3 else ()
        return self.call(f"Set{kind}", self.references(*names), len(names), array, *more)

    def get(self, name: str, count: int | None = None) -> list[Any]:
        """All values of a variable."""
        names, kind = self.elements(name)
        size = count if count is not None else self.size(name)
        array = self._array(self._type(names[0]), size)
        more = (size,) if self.version == 3 else ()
        self.must(f"Get{kind}", self.references(*names), len(names), array, *more)
        return list(array)

    def elements(self, name: str) -> tuple[list[str], str]:
        """The names of its scalars (FMI 3 with arrays: just the name) and the type in function names."""
        if name in self.variables:
            return [name], self._type(name)
        assert name in self._elements, f"no variable {name}"
        names = self._elements[name]
        return names, self._type(names[0])

    def size(self, name: str) -> int:
        """How many values it has."""
        names, _ = self.elements(name)
        if len(names) > 1:
            return len(names)
        size = 1
        for dimension in getattr(self.variables[names[0]], "dimensions", None) or []:
            other = dimension.variable is not None and dimension.variable.name != "wheel_count"
            size *= int(dimension.start) if dimension.start else int(dimension.variable.start) if other else self.wheels
        return size

    @property
    def wheels(self) -> int:
        """N, as the description has it unless the test changed it."""
        return getattr(self, "_wheels", None) or int(self.variables["wheel_count"].start)

    @wheels.setter
    def wheels(self, count: int) -> None:
        self._wheels = count

    def time(self) -> float:
        """The model's time."""
        if self.version == 3:
            return self.get("time")[0]
        value = self.ffi.new("double *")
        self.must("GetRealStatus", 2, value)
        return value[0]

    @property
    def state_count(self) -> int:
        """How many continuous states there are: those of the wheels' speeds only on ground with friction."""
        slips = any(name.startswith("der(wheel_speed_rad_per_s") for name in self.variables)
        return 6 + self.wheels * (2 if slips else 1)

    def states(self) -> list[float]:
        """The continuous states."""
        count = self.state_count
        values = self.ffi.new("double[]", count)
        self.must("GetContinuousStates", values, count)
        return list(values)

    def rates(self) -> list[float]:
        """Their derivatives."""
        count = self.state_count
        values = self.ffi.new("double[]", count)
        self.must("GetDerivatives" if self.version == 2 else "GetContinuousStateDerivatives", values, count)
        return list(values)


def generic(version: int) -> Path:
    """The FMU of the build."""
    return built(f"fmu/Laconic_fmi{version}.fmu")
