"""The references of the documentation site are whole: everything that a user may name stands in one of them."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import cantools
import click
import pytest

import laconic
from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import commands
from laconic_build.site.pages import GROUPS, stage


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site's pages before Sphinx makes HTML of them."""
    folder = tmp_path_factory.mktemp("site") / "pages"
    stage(SOURCE_DIR, folder)
    return folder


def text(pages: Path, name: str) -> str:
    return (pages / f"{name}.md").read_text(encoding="utf-8")


def test_every_function_of_the_public_headers_is_in_the_c_reference(pages: Path) -> None:
    page, headers = text(pages, "reference-c"), SOURCE_DIR / "core_c/include/laconic"
    names = {name for path in headers.glob("*.h") if path.name != "internals.h" for name in
             re.findall(r"^[\w ]+[ *](laconic_\w+)\([^;{]*\);", path.read_text(encoding="utf-8"), re.MULTILINE)}
    assert len(names) > 50 and {name for name in names if name not in page} == set()


def test_every_public_name_of_python_is_in_its_reference(pages: Path) -> None:
    assert all(f"\n## {name}\n" in text(pages, "reference-python") for name in laconic.__all__)


def test_every_command_and_each_of_its_options_is_in_the_reference_of_commands(pages: Path) -> None:
    parts = dict(re.findall(r"^## laconic (\S+)\n(.*?)(?=^## |\Z)", text(pages, "reference-commands"),
                            re.MULTILINE | re.DOTALL))
    context = click.Context(commands)
    assert list(parts) == commands.list_commands(context)
    for name, part in parts.items():
        command = commands.get_command(context, name)
        options = [each for parameter in command.params if not getattr(parameter, "hidden", False)
                   for each in parameter.opts if each.startswith("--")]
        assert options and {each for each in options if each not in part} == set(), name


def test_every_variable_of_the_fmus_and_every_frame_of_the_wire_is_in_a_reference(pages: Path) -> None:
    root = ElementTree.parse(SOURCE_DIR / "modelDescription.xml").getroot()
    fmi, wire = text(pages, "reference-fmi"), text(pages, "wire")
    assert all(f"`{each.get('name')}" in fmi for each in root.iterfind(".//ModelVariables/*"))
    frames = cantools.database.load_file(str(SOURCE_DIR / "firmware_stub/laconic.dbc")).messages
    assert len(frames) > 20 and [each.name for each in frames if each.name not in wire] == []


def test_every_page_has_its_place_in_the_table_of_contents(pages: Path) -> None:
    listed = {name for names in GROUPS.values() for name in names}
    assert {path.stem for path in pages.glob("*.md")} - {"index"} == listed
