"""How the package finds what was compiled: in a build tree, in a wheel, or nowhere."""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions, version
from pathlib import Path

import pytest

from laconic.base.extras import extra_of, missing_module
from laconic.base.paths import SOURCE_DIR

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HOST = SOURCE_DIR / "python"
PROJECT = tomllib.loads((HOST / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def names_in(lines: list[str]) -> set[str]:
    """Distributions that requirements name, but our own."""
    found = (re.match(r"[\w.-]+", line) for line in lines)
    return {each[0].lower() for each in found if each} - {"laconic"}


def installed_alone(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """A command of the package as `pip install host_tests` puts it there: its modules and nothing else."""
    if not (folder / "laconic").exists():
        shutil.copytree(HOST / "laconic", folder / "laconic", ignore=shutil.ignore_patterns("__pycache__", "_built"))
    return subprocess.run([sys.executable, "-m", "laconic", *command], cwd=folder, text=True, capture_output=True,
                          env={"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}, check=False)


@pytest.mark.parametrize("command", [("simulate", "s1"), ("fmu", "s1", "--fmi", "2"), ("rig", "s1")], ids=" ".join)
def test_an_installation_without_core_states_so_in_one_line_with_the_remedy(tmp_path, command):
    done = installed_alone(tmp_path, *command)
    assert done.returncode == 2
    assert done.stderr == (f"laconic: {tmp_path / 'laconic'}: is installed without the compiled core; install a wheel "
                           "(`cmake --build build --target laconic_wheel` makes build/wheel/*.whl)\n")


def test_an_installation_without_core_shows_its_help(tmp_path):
    assert installed_alone(tmp_path, "--help").returncode == 0


def test_a_wheel_is_known_by_what_it_holds(tmp_path):
    (tmp_path / "laconic" / "_built").mkdir(parents=True)
    shutil.copytree(HOST / "laconic", tmp_path / "laconic", dirs_exist_ok=True,
                    ignore=shutil.ignore_patterns("__pycache__", "_built"))
    for folder in ("scenes", "core_c/include"):
        shutil.copytree(SOURCE_DIR / folder, tmp_path / "laconic" / "_built" / "sources" / folder)
    done = installed_alone(tmp_path, "simulate", "s1")
    assert done.returncode == 2
    assert done.stderr.startswith("laconic: lib/laconic_cdef_double.h: is not in the wheel for this system; get the ")


@pytest.mark.parametrize("module, extra", [("can", "rig"), ("cantools", "rig"), ("serial", "rig"), ("e2e", "rig"),
                                           ("scipy", "analysis"), ("sympy", "analysis"), ("fmpy", "report"),
                                           ("cyclonedds", "ros2")])
def test_what_an_extra_brings_is_named_with_the_extra(module, extra):
    error = missing_module(ModuleNotFoundError(f"No module named '{module}.x'", name=f"{module}.x"))
    assert str(error).endswith(f'is not installed; pip install "laconic[{extra}]"')


def test_a_program_that_lacks_an_extra_is_told_which():
    code = ("import sys; sys.modules['scipy'] = None; import laconic\n"
            "try: laconic.analyse\nexcept laconic.BadInput as why: print(why)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == 'this needs scipy, which is not installed; pip install "laconic[analysis]"\n'


HELP_OF_ALL = """
import sys
for module in sys.argv[1:]:
    sys.modules[module] = None
from laconic.cli.main import commands, run
names = commands.list_commands(None)
print("failed:", [name for name in names if run([name, "--help"]) != 0])
"""


def test_every_command_explains_itself_without_an_extra():
    extras = names_in([line for lines in PROJECT["optional-dependencies"].values() for line in lines]) - {"laconic"}
    modules = [module for module, of in packages_distributions().items() if {each.lower() for each in of} & extras]
    assert {"can", "scipy", "fmpy", "jinja2", "mujoco"} <= set(modules)
    done = subprocess.run([sys.executable, "-c", HELP_OF_ALL, *modules], capture_output=True, text=True, check=False)
    assert done.stdout.endswith("failed: []\n"), done.stderr


def test_what_the_package_needs_anyway_belongs_to_no_extra():
    assert extra_of("numpy") == ""


def test_the_lock_is_made_from_what_the_package_needs():
    text = (HOST / "requirements.in").read_text(encoding="utf-8")
    section = text[text.index("# the package\n"):]
    locked = names_in(section[:section.index("\n\n")].splitlines()[1:])
    needed = [*PROJECT["dependencies"], *itertools.chain(*PROJECT["optional-dependencies"].values())]
    assert locked == names_in(needed)


def test_the_version_is_that_of_the_project():
    text = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
    assert f'#define LACONIC_VERSION "{version("laconic")}"' in text
