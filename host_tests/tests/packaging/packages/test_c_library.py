"""The core as a library of C: installed and found, or built inside of another project, whatever its options."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, build_dir

PROGRAM = """
#include <laconic/laconic.h>
#include <stdio.h>

int main(void) {
    puts(laconic_arithmetic_text(laconic_self_test()));
    return laconic_self_test() != LACONIC_ARITHMETIC_SOUND || sizeof(laconic_real) != SIZE;
}
"""
FOUND = """
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES C)
find_package(laconic 0.1 REQUIRED COMPONENTS {component})
add_executable(user user.c)
target_link_libraries(user PRIVATE laconic::{component})
"""
INSIDE = """
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES CXX)
get_cmake_property(before CACHE_VARIABLES)
set(flags_before "${{CMAKE_CXX_FLAGS}} ${{CMAKE_C_FLAGS}} ${{CMAKE_BUILD_TYPE}}")
{taken}
get_cmake_property(after CACHE_VARIABLES)
list(REMOVE_ITEM after ${{before}})
list(FILTER after EXCLUDE REGEX "^(CMAKE_|_CMAKE|FETCHCONTENT_|LACONIC_|laconic|_?core)")
get_property(tests DIRECTORY . PROPERTY TESTS)
if(after OR tests OR NOT flags_before STREQUAL "${{CMAKE_CXX_FLAGS}} ${{CMAKE_C_FLAGS}} ${{CMAKE_BUILD_TYPE}}")
    message(FATAL_ERROR "changed: ${{after}} ${{tests}} ${{CMAKE_C_FLAGS}}")
endif()
add_executable(user user.cpp)
target_link_libraries(user PRIVATE laconic::{component})
"""
SIZES = {"core": 8, "core_single": 4}

pytestmark = pytest.mark.skipif(shutil.which("cmake") is None or shutil.which("gcc") is None, reason="no cmake or gcc")


def run(*command: str | Path, **environment: str) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def refused(*command: str | Path) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    return " ".join(done.stderr.split())


def user(folder: Path, lists: str, component: str, ending: str = "c") -> Path:
    folder.mkdir(parents=True)
    (folder / "CMakeLists.txt").write_text(lists, encoding="utf-8")
    (folder / f"user.{ending}").write_text(PROGRAM.replace("SIZE", str(SIZES[component])), encoding="utf-8")
    return folder


def built_user(source: Path, *options: str) -> Path:
    run("cmake", "-S", source, "-B", source / "build", *options)
    run("cmake", "--build", source / "build", "-j2", "--target", "user")
    return source / "build" / "user"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where this build tree was installed to, and then moved: a folder with a space in its name."""
    folder = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", build_dir(), "--prefix", folder / "first")
    return (folder / "first").rename(folder / "moved here")


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The core alone as a shared library of floats, installed through DESTDIR; its build finds no Python."""
    folder = tmp_path_factory.mktemp("shared")
    tools = folder / "tools"
    tools.mkdir()
    for name in ("cmake", "make", "ninja", "gcc", "cc", "as", "ld", "ar", "ranlib", "ccache"):
        if found := shutil.which(name):
            (tools / name).symlink_to(Path(found).resolve() if name == "cmake" else found)
    compiler = f"-DCMAKE_C_COMPILER={shutil.which('gcc')}"
    run("cmake", "-S", SOURCE_DIR / "core_c", "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Debug", compiler,
        "-DBUILD_SHARED_LIBS=ON", "-DLACONIC_REALS=single", "-DCMAKE_INSTALL_PREFIX=/opt/laconic", PATH=str(tools))
    run("cmake", "--build", folder / "build", "-j2", PATH=str(tools))
    run("cmake", "--install", folder / "build", DESTDIR=str(folder / "stage"), PATH=str(tools))
    return folder / "stage" / "opt" / "laconic"


@pytest.mark.parametrize("component", SIZES)
def test_a_project_finds_the_installed_core_by_find_package(component, whole, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component=component), component)
    assert run(built_user(source, f"-DCMAKE_PREFIX_PATH={whole}")) == "sound\n"


@pytest.mark.skipif(shutil.which("pkg-config") is None, reason="no pkg-config")
@pytest.mark.parametrize(("package", "component"), [("laconic", "core"), ("laconic_single", "core_single")])
def test_pkg_config_finds_it_where_it_was_moved_to(package, component, whole, tmp_path):
    source = user(tmp_path / "user", "", component)
    command = f'eval "cc user.c $(pkg-config --cflags --libs {package}) -o user"'
    libraries = next(whole.glob("lib*/**/pkgconfig"))
    subprocess.run(["sh", "-c", command], cwd=source, check=True,
                   env={**os.environ, "PKG_CONFIG_PATH": str(libraries)})
    assert run(source / "user") == "sound\n"
    assert run("pkg-config", "--modversion", package, PKG_CONFIG_PATH=str(libraries)).strip() == version()


def version() -> str:
    header = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
    return re.findall(r'^#define LACONIC_VERSION "(.*)"$', header, re.MULTILINE)[0]


def test_headers_licence_and_the_two_files_are_installed_and_each_component_by_itself(whole, tmp_path):
    there = {str(path.relative_to(whole)) for path in whole.rglob("*") if path.is_file()}
    headers = {f"include/laconic/{path.name}" for path in (SOURCE_DIR / "core_c/include/laconic").glob("*.h")}
    assert there >= headers | {"share/doc/laconic/LICENSE", "share/laconic/amalgamation/laconic.c"}
    assert there >= {f"share/laconic/soft_double/{name}.c" for name in ("soft_double", "check_double")}
    run("cmake", "--install", build_dir(), "--prefix", tmp_path, "--component", "laconic_amalgamation")
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == {
        "laconic.h", "laconic.c", "laconic_single.h", "laconic_single.c"}


@pytest.mark.nightly
def test_the_core_alone_needs_no_python_and_makes_a_shared_library(shared, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component="core_single"), "core_single")
    assert run(built_user(source, f"-DCMAKE_PREFIX_PATH={shared}")) == "sound\n"
    assert [*shared.rglob("liblaconic_single.*.so")] + [*shared.rglob("liblaconic_single.so.*")]


def test_a_component_that_was_not_built_is_missing_by_its_name(shared, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component="core"), "core")
    message = refused("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={shared}")
    assert "this installation has no core;" in message


def test_a_program_that_would_link_both_scalar_types_is_refused(whole, tmp_path):
    both = FOUND.format(component="core").replace("laconic::core)", "laconic::core laconic::core_single)")
    source = user(tmp_path / "user", both, "core")
    message = refused("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={whole}")
    assert "LACONIC_REAL" in message


FETCHED = """
include(FetchContent)
FetchContent_Declare(laconic SOURCE_DIR "{folder}")
FetchContent_MakeAvailable(laconic)
"""


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
@pytest.mark.parametrize(("taken", "component", "flags"), [
    (FETCHED.format(folder=SOURCE_DIR), "core", "-std=gnu11 -O1 -ffast-math -march=native"),
    (f'add_subdirectory("{SOURCE_DIR / "core_c"}" laconic)', "core_single", "-std=gnu11 -O0")])
def test_a_project_of_cpp_takes_it_in_and_neither_changes_the_other(taken, component, flags, tmp_path):
    source = user(tmp_path / "user", INSIDE.format(taken=taken, component=component), component, "cpp")
    real = "double" if component == "core" else "single"
    program = built_user(source, f"-DCMAKE_C_FLAGS={flags}", f"-DLACONIC_REALS={real}",
                         "-DFETCHCONTENT_FULLY_DISCONNECTED=ON")
    assert run(program) == "sound\n"
