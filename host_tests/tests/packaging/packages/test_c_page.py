"""The page about C: its C++ program prints what the README's does, and its commands name what is there."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from laconic.base.paths import SOURCE_DIR, built

pytestmark = pytest.mark.nightly

PAGE = (SOURCE_DIR / "docs" / "c.md").read_text(encoding="utf-8")
README = (SOURCE_DIR / "README.md").read_text(encoding="utf-8")


@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
def test_its_program_in_cpp_prints_what_the_readme_states(tmp_path):
    (tmp_path / "program.cpp").write_text(re.findall(r"```cpp\n(.*?)```", PAGE, re.DOTALL)[0], encoding="utf-8")
    shutil.copytree(built("amalgamation"), tmp_path / "laconic")
    subprocess.run(["g++", "-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I.", "-x", "c++", "program.cpp",
                    "laconic/laconic.c", "-o", "program"], cwd=tmp_path, check=True)
    printed = subprocess.run(["./program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert printed == re.findall(r"```text\n(.*?)```", README, re.DOTALL)[0]


def test_its_command_makes_the_two_files_by_python_alone(tmp_path):
    command = re.search(r"^PYTHONPATH=.* python3 (.*) laconic$", PAGE, re.MULTILINE)
    assert command is not None
    subprocess.run(["sh", "-c", f"{command[0].removesuffix(' laconic')} {tmp_path}"], cwd=SOURCE_DIR, check=True)
    assert (tmp_path / "laconic.c").read_bytes() == built("amalgamation/laconic.c").read_bytes()


def test_its_targets_components_and_options_exist():
    core, packages = SOURCE_DIR / "core_c", SOURCE_DIR / "packaging" / "c"
    files = [core / "CMakeLists.txt", *(core / "cmake").iterdir(), packages / "CMakeLists.txt"]
    lists = "".join(path.read_text(encoding="utf-8") for path in files)
    assert [name for name in re.findall(r"`(laconic_(?:runtime|development|amalgamation|packages))`", PAGE)
            if name not in lists] == []
    assert [name for name in re.findall(r"--target (\w+)", PAGE) if f"add_custom_target({name} " not in lists] == []
    assert [name for name in re.findall(r"`(LACONIC_[A-Z]+)`", PAGE) if name not in lists] == []
