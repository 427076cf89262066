"""The Python packages: their public interface, the page that shows it, and who may import whom."""

from __future__ import annotations

import ast
import itertools
import re
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions, version
from pathlib import Path

import pytest

import laconic
from laconic.base.extras import extra_of, missing_module
from laconic.base.paths import SOURCE_DIR

PAGE = (SOURCE_DIR / "docs" / "python.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)
PACKAGES = [SOURCE_DIR / "python" / "laconic", SOURCE_DIR / "python" / "laconic_fmu",
            SOURCE_DIR / "packaging" / "laconic_build"]
FILES = [path for package in PACKAGES for path in sorted(package.rglob("*.py"))]


def imported(path: Path) -> set[str]:
    """Names of the modules that a file imports, also those inside of functions."""
    tree = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    found = [[node.module, *(f"{node.module}.{each.name}" for each in node.names)] if isinstance(node, ast.ImportFrom)
             else [each.name for each in node.names] for node in tree if isinstance(node, ast.ImportFrom | ast.Import)]
    return {str(name) for names in found for name in names}


def output_of(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("code, promised", EXAMPLES)
def test_an_example_of_the_page_prints_what_the_page_states(code: str, promised: str) -> None:
    assert output_of(code) == promised


def test_the_page_has_its_examples_and_names_the_whole_interface() -> None:
    assert len(EXAMPLES) == 4
    assert [name for name in laconic.__all__ if f"`{name}" not in PAGE] == []


def test_every_public_name_is_there_and_an_unknown_one_is_refused_with_those_that_are_known() -> None:
    assert all(getattr(laconic, name) is not None for name in laconic.__all__)
    assert set(laconic.__all__) <= set(dir(laconic))
    with pytest.raises(AttributeError, match="no attribute 'simulates'; its names are .*simulate"):
        laconic.simulates  # noqa: B018


def test_importing_the_package_loads_nothing_that_takes_time() -> None:
    code = "import laconic, sys; print(*sorted({'numpy', 'cffi', 'click', 'laconic.core'} & set(sys.modules)))"
    assert output_of(code) == "\n"


def test_no_room_but_the_command_line_imports_the_command_line() -> None:
    cli = PACKAGES[0] / "cli"
    others = [path for path in PACKAGES[0].rglob("*.py") if cli not in path.parents and path.name != "__main__.py"]
    assert [path for path in others if any(name.startswith("laconic.cli") for name in imported(path))] == []


def test_no_file_changes_where_python_looks_for_modules() -> None:
    tests = (SOURCE_DIR / "host_tests" / "tests").rglob("*.py")
    changes = re.compile(r"sys\.path\s*(\.|\[|\+?=)|addsitedir|spec_from_file_location")
    files = [path for path in (*FILES, *tests) if path != Path(__file__).resolve()]
    assert [path for path in files if changes.search(path.read_text(encoding="utf-8"))] == []


def test_a_type_checker_finds_the_types() -> None:
    assert (PACKAGES[0] / "py.typed").exists()


# ---- The rules of CONTRIBUTING.md hold, no test is forgotten, and a program holds no method that it does not call.

C_TESTS = sorted(path for part in ("core_c", "fmu", "firmware_stub") for path in (SOURCE_DIR / part).rglob("test_*.c"))


@pytest.mark.skipif(not (SOURCE_DIR / ".git").exists() or shutil.which("git") is None,
                    reason="needs a checkout, and git")
def test_the_rules_of_contributing_hold() -> None:
    script = SOURCE_DIR / "host_tests" / "assurance" / "rules.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_a_program_that_steps_with_one_method_holds_no_other_and_no_refusals(tmp_path) -> None:
    (tmp_path / "main.c").write_text("""#include "laconic/laconic.h"
        static laconic_plant p;
        static laconic_input held;
        int main(void) {
            p.integrator.chosen = &laconic_rk4;
            return laconic_step(&p.model, &p.integrator, &p.state, &held);
        }
        """)
    sections = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    core = SOURCE_DIR / "core_c"
    folders = [core / "include", *(path for path in (core / "src").iterdir() if path.is_dir())]
    subprocess.run(["gcc", "-std=c99", *sections, "-DLACONIC_WITH_PREPARE=0", *(f"-I{path}" for path in folders),
                    "main.c", *sorted(map(str, (core / "src").rglob("*.c"))), "-o", "program"],
                   cwd=tmp_path, check=True)
    names = subprocess.run(["nm", "program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    functions = set(re.findall(r" [tT] (\w+)", names))
    assert {"laconic_step", "rk4_step"} <= functions
    others = {name for name in functions if name.endswith("_step")} - {"laconic_step", "rk4_step"}
    assert others | functions & {"laconic_step_refusal", "laconic_message", "laconic_prepare", "laconic_phi"} == set()


@pytest.mark.parametrize("path", C_TESTS, ids=lambda path: path.stem)
def test_every_test_that_is_written_is_run(path) -> None:
    text = path.read_text(encoding="utf-8")
    head = re.compile(r"^static void (\w+)\(void\) \{", re.MULTILINE)
    assert set(head.findall(text)) - set(re.findall(r"\w+", head.sub("", text))) == set()
    assert "RUN_TEST(" in text


# ---- How the package finds what was compiled: in a build tree, in a wheel, or nowhere.

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
    assert done.stderr.startswith("laconic: lib/laconic_cdef_double.py: is not in the wheel for this system; get the ")


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


NOT_LOCKED = {"asammdf", "rerun-sdk", "pyfrc", "robotpy"}
"""The first slows each start of python-can by a second; the others have more than 100 MB."""


def test_the_lock_is_made_from_what_the_package_needs():
    text = (HOST / "requirements.in").read_text(encoding="utf-8")
    section = text[text.index("# the package\n"):]
    locked = names_in(section[:section.index("\n\n")].splitlines()[1:])
    needed = [*PROJECT["dependencies"], *itertools.chain(*PROJECT["optional-dependencies"].values())]
    assert NOT_LOCKED < names_in(needed) and locked == names_in(needed) - NOT_LOCKED


def test_the_version_is_that_of_the_project():
    text = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
    assert f'#define LACONIC_VERSION "{version("laconic")}"' in text
