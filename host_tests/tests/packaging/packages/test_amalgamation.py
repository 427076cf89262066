"""The two-file core: compiled in each language that it promises, with the bits of the core that it was made from."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, built
from laconic.core.articulated import ArticulatedVehicle

LANGUAGES = {"gcc": ("c99", "c11", "c17"), "clang": ("c99", "c11", "c17"),
             "g++": ("c++11", "c++14", "c++17", "c++20"), "clang++": ("c++11", "c++14", "c++17", "c++20")}
CASES = [(compiler, standard) for compiler in LANGUAGES if shutil.which(compiler) for standard in LANGUAGES[compiler]]
USUAL = (("gcc", "c99"), ("clang", "c17"), ("g++", "c++20"), ("clang++", "c++11"))  # the others seldom differ
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror"]
CORE = SOURCE_DIR / "core_c"
TRAJECTORY = CORE / "tests" / "bits" / "trajectory_hash.c"
BITS = {"double": ["cefe5b00452642bd", "5344d53e1679ed1e"], "single": ["ba4e7a6dd5f14330", "ecf7bee90946cdc7"]}
OF_FIRMWARE = "-DLACONIC_WITH_EXPONENTIAL_GAUSS=0"  # of images with one method

pytestmark = pytest.mark.skipif(not CASES, reason="neither gcc nor clang")


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder whose folder `laconic` holds the files, as a program of the README includes them."""
    folder = tmp_path_factory.mktemp("pair")
    shutil.copytree(built("amalgamation"), folder / "laconic")
    return folder


def run(*command: str | Path, folder: Path) -> str:
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def language(compiler: str) -> str:
    return "c++" if compiler.endswith("++") else "c"


@pytest.mark.parametrize(("compiler", "standard"), [
    case if case in USUAL else pytest.param(*case, marks=pytest.mark.nightly) for case in CASES])
def test_it_compiles_without_a_warning_in_every_language_that_it_promises(compiler, standard, pair):
    for name in ("laconic.c", "laconic_single.c"):
        run(compiler, "-x", language(compiler), f"-std={standard}", *STRICT, "-fsyntax-only", name,
            folder=pair / "laconic")


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("part", ["FRICTION", *(pytest.param(each, marks=pytest.mark.nightly) for each in (
    "DAMPING", "SLOPE", "POSE", "OWN_WHEELS", "EXPONENTIAL_GAUSS"))])
def test_it_compiles_without_a_warning_if_a_part_is_left_out(compiler, part, pair):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    run(compiler, "-std=c99", *STRICT, "-fsyntax-only", f"-DLACONIC_WITH_{part}=0", "laconic.c",
        folder=pair / "laconic")


@pytest.mark.nightly
@pytest.mark.parametrize("bodies", [0, 1, 2])
def test_an_optimised_build_with_few_bodies_has_no_warning(bodies, pair):
    """Warnings of values that may not be set need the optimiser, and come where loops over bodies are unrolled."""
    if shutil.which("gcc") is None:
        pytest.skip("no gcc")
    run("gcc", "-std=c99", "-O2", *STRICT, f"-DLACONIC_MAX_BODIES={bodies}", "-c", "laconic.c", "-o", os.devnull,
        folder=pair / "laconic")


@pytest.mark.nightly
@pytest.mark.parametrize(("compiler", "standard"), [case for case in CASES if case[1][-2:] in ("99", "11", "20")])
def test_every_public_header_stands_alone_in_every_language_that_it_promises(compiler, standard, tmp_path):
    options = ["-x", language(compiler), f"-std={standard}", *STRICT, "-I", CORE / "include", "-fsyntax-only"]
    for header in sorted((CORE / "include" / "laconic").glob("*.h")):
        (tmp_path / header.name).with_suffix(".c").write_text(f"#include <laconic/{header.name}>\n", encoding="utf-8")
    run(compiler, *options, *sorted(tmp_path.glob("*.c")), folder=tmp_path)


def test_a_step_compiles_without_a_warning_for_sanitizers_too(tmp_path):
    if shutil.which("gcc") is None:
        pytest.skip("no gcc")
    run("gcc", "-std=c99", "-Os", "-fsanitize=address,undefined", *STRICT, "-I", CORE / "include",
        *(word for path in (CORE / "src").iterdir() for word in ("-I", path)), "-c",
        CORE / "src" / "methods" / "exact_flow.c", "-o", "step.o", folder=tmp_path)


@pytest.mark.parametrize(("compiler", "real", "effort"), [
    ("gcc", "double", ["-O1", "-DLACONIC_MAX_BODIES=0"]), *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("gcc", "double", ["-O2"]), ("gcc", "double", ["-O2", "-DLACONIC_MAX_BODIES=1"]), ("clang", "double", ["-O1"]),
        ("g++", "single", ["-O1"])))])
def test_without_any_option_for_bits_it_has_the_bits_of_the_core(compiler, real, effort, pair):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    info = Path("/proc/cpuinfo")
    fusing = ["-march=x86-64-v3"] if info.exists() and {"avx2", "fma"} <= {*info.read_text().split()} else []
    options = [*effort, *fusing, *(["-DLACONIC_SINGLE"] if real == "single" else [])]
    run(compiler, "-x", language(compiler), *options, *STRICT, "-I.", TRAJECTORY, "laconic/laconic.c", "-o", "hash",
        folder=pair)
    assert run("./hash", folder=pair).split()[:2] == BITS[real]  # then a line for each later method


@pytest.mark.nightly
def test_what_firmware_and_fmus_leave_out_changes_no_bit_of_the_other_methods(pair):
    if shutil.which("gcc") is None:
        pytest.skip("no gcc")
    run("gcc", "-O1", OF_FIRMWARE, *STRICT, "-I.", TRAJECTORY, "laconic/laconic.c", "-o", "small", folder=pair)
    assert run("./small", folder=pair).split()[0] == BITS["double"][0]


def test_the_example_of_the_readme_prints_what_the_readme_states(pair):
    found = re.findall(r"```c\n(.*?)```\n\n```text\n(.*?)```", (SOURCE_DIR / "README.md").read_text("utf-8"), re.DOTALL)
    (pair / "example.c").write_text(found[0][0], encoding="utf-8")
    run(CASES[0][0], "-I.", "example.c", "laconic/laconic.c", "-o", "example", folder=pair)
    assert run("./example", folder=pair) == found[0][1]


HINGED = """
#include <stdio.h>

#include "laconic/laconic.h"

/* A carriage on two driven wheels with a caster and a trailer. */
static void build(laconic_articulated_vehicle *v) {
    static const double places[5][2] = {{0.0, 0.25}, {0.0, -0.25}, {-0.05, 0.0}, {-0.6, 0.2}, {-0.6, -0.2}};
    static const int owners[5] = {0, 0, 1, 2, 2};
    v->base.mass_kg = 20;
    v->base.yaw_inertia_kgm2 = 1;
    v->base.com_x_m = (laconic_real)0.1;
    v->base.wheel_radius_m = (laconic_real)0.08;
    v->base.wheel_inertia_kgm2 = (laconic_real)0.002;
    v->base.motor_gain_Nm_per_V = (laconic_real)0.4;
    v->base.motor_damping_Nms = (laconic_real)0.2;
    v->base.wheel_count = 5;
    for (int i = 0; i < 5; i++) {
        v->base.wheel[i].kind = LACONIC_WHEEL_FIXED;
        v->base.wheel[i].x_m = (laconic_real)places[i][0];
        v->base.wheel[i].y_m = (laconic_real)places[i][1];
        v->base.wheel[i].axle_rad = (laconic_real)-1.5707963267948966;
        v->base.wheel[i].undriven = i > 1;
        v->wheel_body[i] = owners[i];
    }
    v->body_count = 2;
    for (int b = 0; b < 2; b++) {
        v->body[b].hinge = LACONIC_HINGE_FREE;
        v->body[b].hinge_x_m = (laconic_real)(b == 0 ? 0.4 : -0.2);
        v->body[b].mass_kg = (laconic_real)(b == 0 ? 0.7 : 8.0);
        v->body[b].com_x_m = (laconic_real)(b == 0 ? -0.04 : -0.5);
        v->body[b].yaw_inertia_kgm2 = (laconic_real)(b == 0 ? 0.001 : 0.5);
    }
}

static void print(const laconic_articulated_model *model, const laconic_articulated_state *state) {
    laconic_articulated_motion m;
    laconic_articulated_motion_of(&m, model, state);
    printf("%a %a %a %a %a %a\\n", (double)m.x_m, (double)m.y_m, (double)m.heading_rad, (double)m.hinge_angle_rad[0],
           (double)m.hinge_angle_rad[1], (double)m.energy_J);
}

int main(void) {
    static laconic_articulated_vehicle vehicle;
    static laconic_articulated_model model;
    static laconic_articulated_integrator integrator;
    static laconic_articulated_state state;
    static laconic_articulated_start start;
    static laconic_articulated_input input;
    build(&vehicle);
    start.hinge_angle_rad[0] = 2;
    if (laconic_articulated_prepare(&model, &vehicle, NULL)) return 1;
    if (laconic_articulated_integrator_prepare(&integrator, LACONIC_ARTICULATED_AUTO, &model, (laconic_real)0.01, NULL))
        return 2;
    if (laconic_articulated_state_set(&state, NULL, &model, &start, &input, NULL)) return 3;
    input.base.voltage_V[0] = 3;
    input.base.voltage_V[1] = 5;
    for (int step = 0; step < 500; step++)
        if (laconic_articulated_step(&model, &integrator, &state, &input, &input, NULL)) return 4;
    print(&model, &state);
    return 0;
}
"""


def hinged_in_python(real: str) -> list[float]:
    """What HINGED prints, by the core itself."""
    axle = {"kind": "fixed", "axle_rad": -1.5707963267948966}
    behind = {**axle, "driven": False}
    robot = ArticulatedVehicle({
        "mass_kg": 20.0, "yaw_inertia_kgm2": 1.0, "com_x_m": 0.1, "wheel_radius_m": 0.08, "wheel_inertia_kgm2": 0.002,
        "motor_gain_Nm_per_V": 0.4, "motor_damping_Nms": 0.2,
        "wheel": [{**axle, "x_m": 0.0, "y_m": 0.25}, {**axle, "x_m": 0.0, "y_m": -0.25},
                  {**behind, "x_m": -0.05, "y_m": 0.0, "body": "caster"},
                  {**behind, "x_m": -0.6, "y_m": 0.2, "body": "trailer"},
                  {**behind, "x_m": -0.6, "y_m": -0.2, "body": "trailer"}],
        "body": [{"name": "caster", "hinge": "free", "hinge_x_m": 0.4, "hinge_y_m": 0.0, "mass_kg": 0.7,
                  "com_x_m": -0.04, "yaw_inertia_kgm2": 0.001},
                 {"name": "trailer", "hinge": "free", "hinge_x_m": -0.2, "hinge_y_m": 0.0, "mass_kg": 8.0,
                  "com_x_m": -0.5, "yaw_inertia_kgm2": 0.5}]}, real)
    plant = robot.plant(step_s=0.01, hinge_angle_rad=[2.0, 0.0])
    plant.run({"voltage_V[1]": 3.0, "voltage_V[2]": 5.0}, 500)
    at = plant.motion()
    return [at.x_m, at.y_m, at.heading_rad, *map(float, at.hinge_angle_rad), at.energy_J]


@pytest.mark.parametrize(("compiler", "real", "effort"), [
    ("gcc", "double", "-O0"), *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("gcc", "double", "-O1"), ("clang++", "single", "-O1")))])
def test_a_vehicle_with_a_caster_and_a_trailer_has_the_bits_of_the_core(compiler, real, effort, pair):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    (pair / "hinged.c").write_text(HINGED, encoding="utf-8")
    options = [effort, *(["-DLACONIC_SINGLE"] if real == "single" else [])]
    run(compiler, "-x", language(compiler), *options, *STRICT, "-I.", "hinged.c", "laconic/laconic.c", "-o", "hinged",
        folder=pair)
    assert [float.fromhex(word) for word in run("./hinged", folder=pair).split()] == hinged_in_python(real)


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("gcc") is None or shutil.which("nm") is None, reason="needs gcc and nm")
def test_without_room_for_bodies_nothing_of_hinges_is_in_the_files(pair):
    names = []
    for bodies in (0, 1):
        run("gcc", "-O0", f"-DLACONIC_MAX_BODIES={bodies}", "-c", "laconic/laconic.c", "-o", "part.o", folder=pair)
        names.append(re.findall(r" [TtRr] (laconic_articulated_\w+)$", run("nm", "part.o", folder=pair), re.MULTILINE))
    assert not names[0]
    assert "laconic_articulated_step" in names[1]


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("gcc") is None or shutil.which("nm") is None, reason="needs gcc and nm")
def test_a_program_without_hinges_links_no_function_of_them(pair):
    (pair / "plain.c").write_text('#include "laconic/laconic.h"\nint main(void) { return (int)laconic_self_test(); }\n',
                                  encoding="utf-8")
    run("gcc", "-O1", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections", "-I.", "plain.c",
        "laconic/laconic.c", "-o", "plain", folder=pair)
    kept = run("nm", "plain", folder=pair)
    assert "laconic_self_test" in kept and "laconic_articulated" not in kept


BOTH = """
#include "laconic/laconic.h"
#include "laconic/laconic_single.h"

int main(void) {
    return (int)(laconic_self_test() + laconic_single_self_test()) + (sizeof(laconic_real) != 8) +
           (sizeof(laconic_single_real) != 4);
}
"""


@pytest.mark.nightly
def test_one_program_holds_both_scalar_types_by_the_pair_with_names_of_its_own(pair):
    (pair / "both.c").write_text(BOTH, encoding="utf-8")
    files = ["both.c", "laconic/laconic.c", "laconic/laconic_single.c"]
    run(CASES[0][0], *STRICT, "-I.", *files, "-o", "both", folder=pair)
    run("./both", folder=pair)


def test_options_that_break_its_promises_are_refused_and_only_in_its_own_file(pair):
    (pair / "user.c").write_text('#include "laconic/laconic.h"\nint main(void) { return 0; }\n', encoding="utf-8")
    run(CASES[0][0], "-ffast-math", "-fsyntax-only", "user.c", folder=pair)
    done = subprocess.run([CASES[0][0], "-ffast-math", "-fsyntax-only", "laconic/laconic.c"], cwd=pair, text=True,
                          capture_output=True, check=False)
    assert done.returncode != 0
    assert "laconic: -ffast-math" in done.stderr


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
def test_constants_in_single_precision_are_refused_in_double_and_change_no_bit_in_single(pair):
    (pair / "user.c").write_text('#include "laconic/laconic.h"\nint main(void) { return 0; }\n', encoding="utf-8")
    for name in ("user.c", "laconic/laconic.c"):
        done = subprocess.run(["gcc", "-fsingle-precision-constant", "-w", "-fsyntax-only", name], cwd=pair, text=True,
                              capture_output=True, check=False)
        assert done.returncode != 0
        assert "needs_compiling_without_fsingle_precision_constant" in done.stderr
    run("gcc", "-O1", "-fsingle-precision-constant", "-DLACONIC_SINGLE", *STRICT, "-I.", TRAJECTORY,
        "laconic/laconic.c", "-o", "hash", folder=pair)
    assert run("./hash", folder=pair).split() == BITS["single"]
    run("gcc", "-fsingle-precision-constant", *STRICT, "-fsyntax-only", "laconic/laconic_single.c", folder=pair)


def test_it_is_made_the_same_twice_by_python_alone_and_names_version_and_licence(pair, tmp_path):
    subprocess.run([sys.executable, "-S", "-m", "laconic_build.c", "amalgamation", str(tmp_path)], check=True,
                   env={**os.environ, "PYTHONPATH": str(SOURCE_DIR / "packaging")})
    texts = {path.name: path.read_bytes() for path in sorted(tmp_path.iterdir())}
    assert texts == {path.name: path.read_bytes() for path in sorted((pair / "laconic").iterdir())}
    licence = (SOURCE_DIR / "LICENSE").read_text(encoding="utf-8").splitlines()
    for name in ("laconic.h", "laconic_single.h"):
        head = texts[name].decode().split("*/")[0]
        assert re.search(r"Laconic \d+\.\d+\.\d+\.", head)
        assert all(line in head for line in licence)


def test_every_package_has_the_version_of_the_header():
    header = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
    version = re.findall(r'^#define LACONIC_VERSION "(.*)"$', header, re.MULTILINE)[0]
    elsewhere = {"modelDescription.xml": r'^    version="([\d.]+)"',
                 "fmu/controller/modelDescription.xml": r'^    version="([\d.]+)"', "CHANGELOG.md": r"^## ([\d.]+)"}
    for name, pattern in elsewhere.items():
        text = (SOURCE_DIR / name).read_text(encoding="utf-8")
        assert re.findall(pattern, text, re.MULTILINE)[:1] == [version], name
