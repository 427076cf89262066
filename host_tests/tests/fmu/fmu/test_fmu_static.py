"""Source FMUs of different variants in one static program: no name in common, and each gives its own results."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import zipfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from fmu_importer import Importer, generic

from laconic.base.paths import build_dir, built

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None or shutil.which("nm") is None, reason="needs gcc and nm")
HEADERS = build_dir() / "parts" / "fmi"

PROGRAM = """
#include <stdio.h>
#define FMI2_FUNCTION_PREFIX {prefix}
#include "fmi2Functions.h"
/* copies of the header that know no prefix */
#define PASTED(a, b) a##b
#define NAMED(a, b) PASTED(a, b)
#undef fmi2FullName
#define fmi2FullName(name) NAMED(FMI2_FUNCTION_PREFIX, name)
fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,
                              fmi2Boolean);
fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
fmi2Status fmi2EnterInitializationMode(fmi2Component);
fmi2Status fmi2ExitInitializationMode(fmi2Component);
fmi2Status fmi2SetReal(fmi2Component, const fmi2ValueReference *, size_t, const fmi2Real *);
fmi2Status fmi2GetReal(fmi2Component, const fmi2ValueReference *, size_t, fmi2Real *);
fmi2Status fmi2DoStep(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
fmi2Status fmi2GetDirectionalDerivative(fmi2Component, const fmi2ValueReference *, size_t, const fmi2ValueReference *,
                                        size_t, const fmi2Real *, fmi2Real *);

int run_{prefix}(void) {{
    const fmi2CallbackFunctions functions = {{NULL, NULL, NULL, NULL, NULL}};
    const fmi2ValueReference voltage = {voltage}U, x = {x}U;
    const fmi2Real five = 5, one = 1;
    fmi2Real value = 0, sensitivity = 0;
    fmi2Component c = fmi2Instantiate("v", fmi2CoSimulation, "{guid}", "", &functions, 0, 0);
    if (c == NULL || fmi2SetupExperiment(c, 0, 0, 0, 0, 0) || fmi2EnterInitializationMode(c) ||
        fmi2ExitInitializationMode(c) || fmi2SetReal(c, &voltage, 1, &five) || fmi2DoStep(c, 0, 0.5, 1) ||
        fmi2GetReal(c, &x, 1, &value) ||
        fmi2GetDirectionalDerivative(c, &x, 1, &voltage, 1, &one, &sensitivity)) return 1;
    printf("%.17g %.17g\\n", value, sensitivity);
    return 0;
}}
"""


def sources_of(fmu: Path, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder, [name for name in archive.namelist() if name.startswith("sources/")])
    return folder / "sources"


def compiled(sources: Path, *options: str) -> list[Path]:
    """The objects of all C files, by the compiler options that `buildDescription.xml` names."""
    folders = sorted({path.parent for path in sources.rglob("*.c")})

    def compile_folder(folder: Path) -> list[Path]:
        names = [path.name for path in folder.glob("*.c")]
        subprocess.run(["gcc", "-std=c99", "-O0", "-ffp-contract=off", "-fno-tree-slp-vectorize", *options,
                        f"-I{sources}", f"-I{HEADERS}", "-c", *names], cwd=folder, check=True)
        return sorted(folder.glob("*.o"))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [path for objects in pool.map(compile_folder, folders) for path in objects]


def global_names(objects: Sequence[Path]) -> set[str]:
    command = ["nm", "-g", "--defined-only", *map(str, objects)]
    listed = subprocess.run(command, capture_output=True, text=True, check=True)
    return {words[2] for line in listed.stdout.splitlines() if len(words := line.split()) == 3}


@pytest.mark.nightly
@needs_gcc
def test_two_source_fmus_in_one_static_program_give_each_its_own_results(tmp_path: Path) -> None:
    objects, names, expected = [], [], []
    for variant in ("Laconic", "LaconicDerivatives"):
        fmu, prefix = built(f"fmu/{variant}_fmi2.fmu"), f"{variant}_"
        own = compiled(sources_of(fmu, tmp_path / variant))
        names.append(global_names(own))
        assert {name for name in names[-1] if not name.startswith(prefix)} == set()
        assert {f"{prefix}fmi2DoStep", f"{prefix}fmi2Instantiate"} <= names[-1]
        with Importer(fmu) as importer:
            row = {name: importer.variables[name].valueReference for name in ("voltage_V[1]", "x_m")}
            program = PROGRAM.format(prefix=prefix, guid=importer.description.guid, voltage=row["voltage_V[1]"],
                                     x=row["x_m"])
            importer.initialize()
            importer.must("SetReal", importer.references("voltage_V[1]"), 1, [5.0])
            assert importer.step(0.0, 0.5) == 0
            sensitivity = importer.ffi.new("double[1]")
            importer.must("GetDirectionalDerivative", importer.references("x_m"), 1,
                          importer.references("voltage_V[1]"), 1, [1.0], sensitivity)
            expected.append((importer.get("x_m")[0], sensitivity[0]))
        (tmp_path / f"{variant}.c").write_text(program, encoding="utf-8")
        objects += [*own, tmp_path / f"{variant}.c"]
    assert names[0] & names[1] == set()
    (tmp_path / "main.c").write_text("int run_Laconic_(void), run_LaconicDerivatives_(void);\n"
                                     "int main(void) { return run_Laconic_() + run_LaconicDerivatives_(); }\n",
                                     encoding="utf-8")
    subprocess.run(["gcc", f"-I{HEADERS}", str(tmp_path / "main.c"), *map(str, objects), "-o", str(tmp_path / "both")],
                   check=True)
    lines = subprocess.run([tmp_path / "both"], capture_output=True, text=True, check=True).stdout.splitlines()
    found = [tuple(map(float, line.split())) for line in lines]
    assert found == expected
    assert found[0][1] != found[1][1]  # at an instant the voltage does not move it, over a step it does


@needs_gcc
@pytest.mark.nightly
@pytest.mark.parametrize("name", ["Laconic_fmi3", "LaconicEstimate_fmi2", "LaconicEstimate_fmi3",
                                  "LaconicController_fmi2", "LaconicController_fmi3", "LaconicDerivatives_fmi3",
                                  "LaconicNode_fmi3", "LaconicCanBus_fmi3", "LaconicCanController_fmi3",
                                  "LaconicArticulated_fmi2", "LaconicArticulated_fmi3", "LaconicSlipping_fmi2",
                                  "LaconicSlipping_fmi3"])
def test_every_name_of_a_source_fmu_has_the_prefix_of_its_variant(name: str, tmp_path: Path) -> None:
    identifier, _, version = name.partition("_")
    names = global_names(compiled(sources_of(built(f"fmu/{name}.fmu"), tmp_path), "-Wall", "-Werror"))
    ours = re.compile(rf"{identifier}_(?:{version}\w+|{version[3]}_\w+)$")
    assert [each for each in sorted(names) if not ours.match(each)] == []


@pytest.mark.parametrize("variant", ["Laconic", "LaconicDerivatives", "LaconicEstimate", "LaconicArticulated",
                                     "LaconicSlipping"])
@pytest.mark.parametrize("version", [2, 3])
def test_each_variant_has_a_model_identifier_of_its_own(variant: str, version: int) -> None:
    with Importer(built(f"fmu/{variant}_fmi{version}.fmu")) as importer:
        kinds = [importer.description.coSimulation, importer.description.modelExchange]
        assert {kind.modelIdentifier for kind in kinds if kind is not None} == {variant}


@needs_gcc
def test_sources_refuse_constants_in_single_precision_by_a_line_that_names_the_option(tmp_path: Path) -> None:
    sources = sources_of(built("fmu/LaconicController_fmi2.fmu"), tmp_path)
    for name in ("variable_table.c", "co_simulation.c"):
        done = subprocess.run(["gcc", "-std=c99", "-w", "-fsyntax-only", "-fsingle-precision-constant", "-I.", name],
                              cwd=sources, capture_output=True, text=True, check=False)
        assert done.returncode != 0
        assert "fmu_needs_compiling_without_fsingle_precision_constant" in done.stderr


@needs_gcc
def test_macros_of_windows_and_embedded_compilers_do_not_change_the_sources(tmp_path: Path) -> None:
    macros = [f"-D{word}=!" for word in ("near", "far", "huge", "small", "hyper", "pascal", "cdecl", "interface")]
    sources = sources_of(built("fmu/LaconicArticulated_fmi3.fmu"), tmp_path)
    names = sorted(path.name for path in sources.glob("*.c"))
    subprocess.run(["gcc", "-std=c99", "-fsyntax-only", "-Wall", "-Werror", *macros, "-I.", f"-I{HEADERS}", *names],
                   cwd=sources, check=True)


@needs_gcc
@pytest.mark.nightly
@pytest.mark.parametrize("version", [2, 3])
def test_the_shared_library_that_an_importer_compiles_exports_the_plain_names(version: int, tmp_path: Path) -> None:
    sources = sources_of(generic(version), tmp_path)
    for option in ("-DLaconic_EXPORTS", f"-DFMI{version}_OVERRIDE_FUNCTION_PREFIX", f"-DFMI{version}_FUNCTION_PREFIX="):
        assert f"fmi{version}DoStep" in global_names(compiled(sources, "-fPIC", option))
