"""The Python packages: their public interface, the page that shows it, and who may import whom."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import laconic
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
