"""A new user with a C compiler, then with CMake, then with Node: the archives of the release, and nothing else."""

from __future__ import annotations

import re
import shutil
import tarfile
import zipfile
from pathlib import Path

import pytest
from release_folder import DIST, PRINTED, VERSION, run

from laconic_build.release import archives

CORE = f"laconic-core-{VERSION}"
FETCHED = """\
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES C)
include(FetchContent)
FetchContent_Declare(laconic URL "{url}" URL_HASH SHA256={digest})
FetchContent_MakeAvailable(laconic)
add_executable(program program.c)
target_link_libraries(program PRIVATE laconic::core)
"""
needs_cmake = pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake")


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The archive of the core, unpacked into an empty folder."""
    folder = tmp_path_factory.mktemp("cmake")
    with tarfile.open(DIST / f"{CORE}.tar.gz") as tape:
        tape.extractall(folder)
    return folder / CORE


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_two_files_compile_as_their_readme_states_and_print_the_line_of_the_project(tmp_path: Path) -> None:
    with zipfile.ZipFile(DIST / f"laconic-amalgamation-{VERSION}.zip") as opened:
        opened.extractall(tmp_path)
    folder = tmp_path / f"laconic-amalgamation-{VERSION}"
    text = (folder / "README.md").read_text(encoding="utf-8")
    compiling, running = re.findall(r"^    (.*)$", text, re.MULTILINE)
    run(folder, *compiling.split())
    assert run(folder, running) == PRINTED
    assert PRINTED.strip() in text


@needs_cmake
def test_the_core_is_installed_and_found_by_its_example(core: Path) -> None:
    prefix = core.parent / "installed here"
    run(core, "cmake", "-S", ".", "-B", "build")
    run(core, "cmake", "--build", "build", "-j2")
    run(core, "cmake", "--install", "build", "--prefix", str(prefix))
    run(core / "example", "cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run(core / "example", "cmake", "--build", "build")
    assert run(core / "example", "build/program") == PRINTED
    assert (prefix / "share/doc/laconic/LICENSE").read_bytes() == (core / "LICENSE").read_bytes()


@needs_cmake
def test_fetch_content_takes_the_archive_by_its_checksum(core: Path, tmp_path: Path) -> None:
    archive = DIST / f"{CORE}.tar.gz"
    lists = FETCHED.format(url=archive.resolve().as_uri(), digest=archives.stated(DIST)[archive.name])
    (tmp_path / "CMakeLists.txt").write_text(lists, encoding="utf-8")
    shutil.copyfile(core / "example" / "program.c", tmp_path / "program.c")
    run(tmp_path, "cmake", "-S", ".", "-B", "build")
    run(tmp_path, "cmake", "--build", "build", "-j2")
    assert run(tmp_path, "build/program") == PRINTED


def test_the_zip_of_the_core_holds_the_same_as_its_tar(tmp_path: Path) -> None:
    with zipfile.ZipFile(DIST / f"{CORE}.zip") as opened, tarfile.open(DIST / f"{CORE}.tar.gz") as tape:
        for entry in tape:
            file = tape.extractfile(entry)
            assert file is not None
            assert opened.read(entry.name) == file.read()
        assert opened.namelist() == tape.getnames()


@pytest.mark.skipif(shutil.which("node") is None, reason="no node")
def test_the_npm_package_runs_its_readmes_example(tmp_path: Path) -> None:
    with tarfile.open(DIST / f"laconic-robots-{VERSION}.tgz") as tape:
        tape.extractall(tmp_path / "unpacked")
    place = tmp_path / "node_modules" / "laconic-robots"
    shutil.copytree(tmp_path / "unpacked" / "package", place)
    script = re.findall(r"```js\n(.*?)```", (place / "README.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    (tmp_path / "script.mjs").write_text(script, encoding="utf-8")
    assert run(tmp_path, str(shutil.which("node")), "script.mjs") == PRINTED
