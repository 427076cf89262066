"""Definitions that change structs: a program with others than the library's does not link; the linker names them."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, built

USUAL: tuple[str, ...] = ()
OTHERS = ["LACONIC_SINGLE", "LACONIC_MAX_WHEELS=4", "LACONIC_MAX_SUPPORTS=2", "LACONIC_WITH_OWN_WHEELS=0",
          "LACONIC_WITH_SLOPE=0", "LACONIC_WITH_FRICTION=0", "LACONIC_WITH_EXPONENTIAL_GAUSS=0"]
NODE_OTHERS = ["LACONIC_NODE_CAN_FD=0", "LACONIC_NODE_WITH_DRIVES=0", "LACONIC_NODE_WITH_SENSORS=0",
               "LACONIC_NODE_WITH_XCP=0", "LACONIC_NODE_WITH_SLIP=0", "LACONIC_NODE_AXIS_BYTES=512",
               "LACONIC_MAX_WHEELS=4", "LACONIC_SINGLE"]
NAMED = {"LACONIC_NODE_WITH_SLIP": "HINGES_1_of_bodies"}  # what the linker misses, where it is not the name
CALLS = {
    "plant": "static laconic_plant p; laconic_start s = {0}; laconic_vehicle v = {0};"
             "return (int)laconic_plant_start(&p, &v, &laconic_rk4, (laconic_real)0.01, &s, NULL);",
    "prepare": "static laconic_model m; laconic_vehicle v = {0}; return (int)laconic_prepare(&m, &v, NULL);",
    "check": "laconic_vehicle v = {0}; return (int)laconic_vehicle_check(&v, NULL);",
    "motor": "laconic_vehicle v = {0}; laconic_motor m = {0}; return (int)laconic_motor_fit(&v, &m, NULL);",
    "state": "static laconic_model m; laconic_state q; laconic_start s = {0};"
             "return (int)laconic_state_set(&q, &m, &s, NULL);",
    "integrator": "static laconic_model m; static laconic_integrator i;"
                  "return (int)laconic_integrator_prepare(&i, &laconic_rk4, &m, (laconic_real)0.01, NULL);",
    "contact": "static laconic_contact c; laconic_vehicle v = {0}; return (int)laconic_contact_prepare(&c, &v, NULL);",
    "matrices": "static laconic_matrices m; laconic_vehicle v = {0}; return (int)laconic_matrices_of(&m, &v, NULL);",
}
COMPILER = shutil.which("gcc") or shutil.which("clang")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="neither gcc nor clang")


def run(folder: Path, *words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(COMPILER), "-O0", *map(str, words)], cwd=folder, capture_output=True, text=True,
                          check=False)


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The two files, the core compiled without a definition, and programs that call it."""
    folder = tmp_path_factory.mktemp("definitions")
    shutil.copytree(built("amalgamation"), folder / "laconic")
    compile_core(folder, 0)
    for name, call in CALLS.items():
        text = f"#include <laconic/laconic.h>\nint main(void) {{ {call} }}\n"
        (folder / f"{name}.c").write_text(text, encoding="utf-8")
    return folder


def compile_core(folder: Path, number: int) -> None:
    """NUMBER.o: the core by one definition, or by none as 0."""
    definition = OTHERS[number - 1] if number else ""
    effort = "-O1" if "FRICTION" in definition else "-O0"
    done = run(folder, effort, "-ffunction-sections", *([f"-D{definition}"] if definition else []), "-c",
               "laconic/laconic.c", "-o", f"{number}.o")
    assert done.returncode == 0, done.stderr


def missing(done: subprocess.CompletedProcess[str]) -> set[str]:
    assert done.returncode != 0
    return set(re.findall(r"laconic_built_with(?:out)?_(\w+)", done.stderr))


@pytest.mark.nightly
@pytest.mark.parametrize("number", range(1, len(OTHERS) + 1))
def test_a_program_and_a_library_that_differ_by_one_definition_do_not_link_and_it_is_named(number, libraries):
    definition = OTHERS[number - 1]
    name = definition.partition("=")[0]
    compile_core(libraries, number)
    for option, library in ((["-D" + definition], "0.o"), ([], f"{number}.o")):
        named = missing(run(libraries, *option, "-I.", "plant.c", library, "-o", "program"))
        assert len(named) == 1 and all(each.startswith(name) for each in named)
    done = run(libraries, f"-D{definition}", "-I.", "plant.c", f"{number}.o", "-o", "program")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("call", CALLS)
def test_every_function_that_a_program_begins_with_is_checked(call, libraries):
    differs = run(libraries, "-DLACONIC_MAX_WHEELS=5", "-I.", f"{call}.c", "0.o", "-Wl,--gc-sections", "-o", "program")
    assert missing(differs) == {"LACONIC_MAX_WHEELS_5"}
    same = run(libraries, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I.", f"{call}.c", "0.o", "-o", "program")
    assert same.returncode == 0, same.stderr


def test_a_part_of_the_core_that_the_program_leaves_out_is_named(libraries):
    differs = run(libraries, "-DLACONIC_WITH_SLOPE=0", "-I.", "plant.c", "0.o", "-Wl,--gc-sections", "-o", "program")
    assert missing(differs) == {"LACONIC_WITH_SLOPE_0"}


HINGED = {
    "prepare": "static laconic_articulated_model m; static laconic_articulated_vehicle v;"
               "return (int)laconic_articulated_prepare(&m, &v, NULL);",
    "state": "static laconic_articulated_model m; static laconic_articulated_state q; "
             "static laconic_articulated_start s; static laconic_articulated_input u; "
             "return (int)laconic_articulated_state_set(&q, NULL, &m, &s, &u, NULL);",
    "integrator": "static laconic_articulated_model m; static laconic_articulated_integrator i;"
                  "return (int)laconic_articulated_integrator_prepare(&i, 0, &m, (laconic_real)0.01, NULL);"}


@pytest.mark.parametrize("call", HINGED)
def test_a_program_with_hinges_that_differs_does_not_link_and_one_without_needs_not_agree_on_bodies(call, libraries):
    text = f"#include <laconic/laconic.h>\nint main(void) {{ {HINGED[call]} }}\n"
    (libraries / "hinged.c").write_text(text, encoding="utf-8")
    for definition, name in (("LACONIC_MAX_BODIES=4", "LACONIC_MAX_BODIES_4"), ("LACONIC_SINGLE", "LACONIC_SINGLE")):
        assert name in missing(run(libraries, f"-D{definition}", "-I.", "hinged.c", "0.o", "-Wl,--gc-sections",
                                   "-o", "program"))
    same = run(libraries, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I.", "hinged.c", "0.o", "-o", "program")
    assert same.returncode == 0, same.stderr
    other = run(libraries, "-DLACONIC_MAX_BODIES=4", "-I.", "plant.c", "0.o", "-o", "program")
    assert other.returncode == 0, other.stderr


@pytest.mark.nightly
def test_a_program_that_includes_the_core_itself_needs_nothing_more(libraries):
    text = f'#include "laconic/laconic.h"\n#include "laconic/laconic.c"\nint main(void) {{ {CALLS["plant"]} }}\n'
    (libraries / "all.c").write_text(text, encoding="utf-8")
    assert run(libraries, "-O0", "-I.", "all.c", "-o", "program").returncode == 0


PLUGIN = """
#include <laconic/laconic.h>
double NAME(void);
double NAME(void) {
    static laconic_plant plant;
    const laconic_vehicle puck = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    const laconic_start start = {.nu_rad_per_s = {1, 0, 0}};
    const laconic_input none = {0};
    laconic_pose pose;
    if (laconic_plant_start(&plant, &puck, &laconic_auto, (laconic_real)0.1, &start, NULL) != LACONIC_OK) return -1;
    if (laconic_plant_run(&plant, &none, 10, NULL) != LACONIC_OK) return -2;
    laconic_pose_of(&pose, &plant.model, &plant.state);
    return sizeof(laconic_real) == 4 ? 10 + (double)(float)pose.x_m : (double)pose.x_m;
}
"""
PLUGINS = {"usual": [], "single": ["-DLACONIC_SINGLE"], "four": ["-DLACONIC_MAX_WHEELS=4"]}
IN_ONE_PROCESS = """
import ctypes, os, sys
loaded = [(name, ctypes.CDLL(f"./{name}.so", mode=ctypes.RTLD_GLOBAL | os.RTLD_NOW)) for name in sys.argv[1:]]
for name, library in loaded:
    function = library[name]
    function.restype = ctypes.c_double
    print(round(function(), 5))
"""


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names of plugins meet in ELF alone")
@pytest.mark.parametrize("order", [
    ("usual", "single", "four"), ("single", "four", "usual"), ("four", "usual", "single")])
def test_plugins_with_other_builds_in_one_process_call_their_own_functions(order, libraries):
    (libraries / "plugin.c").write_text(PLUGIN, encoding="utf-8")
    for name, options in PLUGINS.items():
        if not (libraries / f"{name}.so").exists():
            done = run(libraries, "-O0", "-fPIC", "-shared", *options, f"-DNAME={name}", "-I.", "plugin.c",
                       "laconic/laconic.c", "-o", f"{name}.so")
            assert done.returncode == 0, done.stderr
    done = subprocess.run([sys.executable, "-c", IN_ONE_PROCESS, *order], cwd=libraries, capture_output=True, text=True,
                          check=True)
    assert done.stdout.split() == [{"usual": "1.0", "single": "11.0", "four": "1.0"}[name] for name in order]


@pytest.mark.nightly
def test_a_library_of_unusual_definitions_exports_its_names_where_it_is_asked_to(libraries):
    for name, options, exported in (("asked", ["-DLACONIC_EXPORTED"], True), ("hidden", [], False)):
        done = run(libraries, "-O0", "-fPIC", "-shared", "-DLACONIC_SINGLE", *options, "laconic/laconic.c", "-o",
                   f"{name}.so")
        assert done.returncode == 0, done.stderr
        assert hasattr(ctypes.CDLL(str(libraries / f"{name}.so")), "laconic_plant_start") == exported


IN_PYTHON = """
import ctypes, os, sys
from laconic.base.paths import library
for name in sys.argv[1:]:
    ctypes.CDLL(str(library(name)), mode=ctypes.RTLD_GLOBAL | os.RTLD_NOW)
from laconic.core import load
for real in ("single", "double"):
    core = load(real)
    puck = core.vehicle({"mass_kg": 1, "yaw_inertia_kgm2": 1, "wheel_radius_m": 1, "wheel": []})
    plant = core.plant(puck, "auto", 0.1, nu_rad_per_s=[1, 0, 0])
    plant.run(core.input(), 10)
    print(round(plant.c.state.x_m.value, 5))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names of plugins meet in ELF alone")
@pytest.mark.parametrize("order", [("laconic_double", "laconic_single"), ("laconic_single", "laconic_node_double")])
def test_the_shared_libraries_of_both_scalar_types_are_in_one_process(order):
    done = subprocess.run([sys.executable, "-c", IN_PYTHON, *order], capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["1.0", "1.0"], done.stderr


def test_the_page_shows_the_linkers_message():
    page = (SOURCE_DIR / "docs" / "c.md").read_text(encoding="utf-8")
    assert "undefined reference to `laconic_built_with_LACONIC_MAX_WHEELS_4'" in page


NODE = """
#include "laconic_node/node.h"
#include "laconic_node/slcan.h"
#include "laconic_secure/gate.h"
int main(void) {
    static laconic_node node;
    static laconic_slcan slcan;
    static laconic_gate gate;
    const laconic_node_config config = {.method = laconic_method_by_number};
    const uint8_t key[16] = {0};
    laconic_slcan_init(&slcan, 0);
    laconic_gate_init(&gate, 0, key);
    return laconic_node_init(&node, &config, 0);
}
"""


@pytest.mark.parametrize("definition", [None, *NODE_OTHERS])
def test_a_port_and_a_node_that_differ_do_not_link(definition, tmp_path):
    (tmp_path / "port.c").write_text(NODE, encoding="utf-8")
    wire = built("firmware_stub/wire")
    folders = [SOURCE_DIR / "core_c/include", SOURCE_DIR / "firmware_stub/include", wire]
    libraries = [built(f"firmware_stub/lib{name}.a") for name in ("laconic_node_double", "laconic_secure")]
    libraries += [built("firmware_stub/liblaconic_wire.a"), built("core_c/liblaconic.a")]
    done = run(tmp_path, "-DLACONIC_NODE_WITH_ESTIMATE=1", "-DLACONIC_NODE_WITH_HINGES=1", "-DLACONIC_NODE_WITH_SLIP=1",
               "-DLACONIC_NODE_WITH_XCP=1",
               *([f"-D{definition}"] if definition else []),
               *(f"-I{folder}" for folder in folders), "port.c", *libraries, "-o", "port")
    if definition is None:
        assert done.returncode == 0, done.stderr
    else:
        name = definition.partition("=")[0]
        assert any(NAMED.get(name, name) in each for each in missing_of_node(done))


def missing_of_node(done: subprocess.CompletedProcess[str]) -> set[str]:
    assert done.returncode != 0
    return set(re.findall(r"laconic_(?:node_|slcan_|gate_)?built_with(?:out)?_(\w+)", done.stderr))
