"""docs/architecture.md is true of the tree, and every page can be found."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import cantools
import click
import pytest

import laconic
from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import commands
from laconic_build.site.__main__ import CONFIG
from laconic_build.site.pages import GROUPS, stage

PAGE = (SOURCE_DIR / "docs/architecture.md").read_text(encoding="utf-8")


def test_every_folder_that_the_page_names_is_there() -> None:
    cells = re.findall(r"^\| (`.*?) \|", PAGE.split("# From a vehicle")[0], re.MULTILINE)
    named = {name for cell in cells for name in re.findall(r"`(\S+)`", cell)}
    assert {"core_c/src", "python/laconic", "host_tests", "scenes"} <= named
    assert [name for name in named if not (SOURCE_DIR / name).is_dir()] == []


def test_each_function_on_the_way_of_a_voltage_is_defined_in_its_file() -> None:
    rows = re.findall(r"^\| `(\S+)` \| `(\w+)` \|", PAGE, re.MULTILINE)
    assert len(rows) > 3
    for path, function in rows:
        body = rf"^\w[\w *]*\b{function}\([^;{{]*\) \{{"
        text = (SOURCE_DIR / path).read_text(encoding="utf-8")
        assert re.search(body, text, re.MULTILINE), f"{path} has no {function}"


def test_every_file_and_c_name_that_the_page_mentions_exists() -> None:
    parts = ("core_c", "fmu", "firmware_stub", "python", "packaging")
    sources = [path for part in parts for path in (SOURCE_DIR / part).rglob("*")]
    files = {path.name for path in sources} | {path.name for path in SOURCE_DIR.iterdir()}
    names = {name.rpartition("/")[2] for name in re.findall(r"`([\w/.]+\.(?:c|h|py|xml|dbc|md))`", PAGE)}
    assert {name for name in names if "NAME" not in name} - files == set()
    in_c = [path.read_text(encoding="utf-8") for path in sources if path.suffix in (".c", ".h")]
    words = set(re.findall(r"\w+", "\n".join(in_c)))
    packages = {path.name for path in SOURCE_DIR.glob("p*/laconic*")}
    assert set(re.findall(r"`((?:laconic|fmu|fmi\d|LACONIC)_?\w+)`", PAGE)) - words - packages == set()


def test_every_folder_of_tests_that_a_page_names_is_there() -> None:
    pages = [SOURCE_DIR / "README.md", SOURCE_DIR / "CONTRIBUTING.md", *sorted((SOURCE_DIR / "docs").glob("*.md"))]
    named = {(page.name, path.rstrip(".")) for page in pages
             for path in re.findall(r"host_tests/[\w/.]+", page.read_text(encoding="utf-8"))}
    assert len(named) > 10
    assert [each for each in sorted(named) if not (SOURCE_DIR / each[1]).exists()] == []


def test_every_page_can_be_reached_from_the_readme() -> None:
    seen, todo = set(), [SOURCE_DIR / "README.md"]
    while todo:
        page = todo.pop()
        seen.add(page)
        links = re.findall(r"\]\(([^)#:]+\.md)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
        todo += [target for link in links if (target := (page.parent / link).resolve()) not in seen]
    assert set((SOURCE_DIR / "docs").glob("*.md")) <= seen


def anchors(page: Path) -> set[str]:
    """The headings of a page as a link names them."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"),
                                                flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each.lower()).strip().replace(" ", "-") for each in headings}


@pytest.mark.parametrize("page", [SOURCE_DIR / "README.md", SOURCE_DIR / "CONTRIBUTING.md",
                                  *sorted((SOURCE_DIR / "docs").glob("*.md"))], ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file_and_a_heading(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)", page.read_text(encoding="utf-8"))
    local = [(page.parent / target if target else page, anchor) for target, anchor in links if "://" not in target]
    assert [str(target) for target, _ in local if not target.exists()] == []
    assert [f"{target.name}#{anchor}" for target, anchor in local
            if anchor and target.suffix == ".md" and anchor not in anchors(target)] == []



# ---- docs/glossary.md explains every symbol that pages and headers use, each word once, and names what the code
# has.

GLOSSARY = (SOURCE_DIR / "docs" / "glossary.md").read_text(encoding="utf-8")
HEADERS = "\n".join(path.read_text(encoding="utf-8") for path in (SOURCE_DIR / "core_c/include/laconic").glob("*.h"))
PAGES = [SOURCE_DIR / "README.md", *(SOURCE_DIR / "docs").glob("*.md"), SOURCE_DIR / "core_c/include/laconic/laconic.h"]
LETTER = re.compile(r"[Α-Ωα-ω]")
NO_SYMBOLS = {"Σ", "π", "Ω"}  # the sum, the number and the ohm


def first_cells(part: str) -> list[str]:
    """The first cell of each row of the tables under a heading, the heads of the tables left out."""
    rows = re.findall(r"^\| (.*?) \|", GLOSSARY.split(f"\n## {part}\n")[1].split("\n## ")[0], re.MULTILINE)
    return [row for row in rows if row not in ("---", "symbol", "word")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_greek_letter_of_a_page_is_a_symbol_of_the_glossary(page):
    explained = set(LETTER.findall("".join(first_cells("Symbols")))) | NO_SYMBOLS
    assert set(LETTER.findall(page.read_text(encoding="utf-8"))) - explained == set()


def test_the_names_in_code_that_the_glossary_gives_are_in_the_headers():
    named = re.findall(r"`([\w.\[\]]+)`", GLOSSARY)
    names = {re.sub(r"\[i\]", "", name).split(".")[0] for name in named if name.isidentifier() or "[i]" in name}
    assert len(names) > 30
    assert [name for name in sorted(names) if "_" in name and not re.search(rf"\b{name}\b", HEADERS)] == []


def test_every_word_and_every_symbol_has_one_row():
    for part in ("Symbols", "Words"):
        words = [word.strip(" *") for cell in first_cells(part) for word in cell.split(",")]
        assert len(words) > 30
        assert sorted(words) == sorted(set(words))


def test_every_page_with_words_of_the_project_leads_to_the_glossary():
    for name in ("fmu", "scenes", "paper", "rig", "wire", "architecture", "integrators", "python"):
        assert "(glossary.md)" in (SOURCE_DIR / "docs" / f"{name}.md").read_text(encoding="utf-8"), name


# ---- The references of the documentation site are whole: everything that a user may name stands in one of them.

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
    fmi, wire = text(pages, "reference-fmi"), text(pages, "wire")
    for name in ("modelDescription.xml", "fmu/articulated/modelDescription.xml"):
        root = ElementTree.parse(SOURCE_DIR / name).getroot()
        assert all(f"`{each.get('name')}" in fmi for each in root.iterfind(".//ModelVariables/*"))
    frames = cantools.database.load_file(str(SOURCE_DIR / "firmware_stub/laconic.dbc")).messages
    assert len(frames) > 20 and [each.name for each in frames if each.name not in wire] == []


def test_every_page_has_its_place_in_the_table_of_contents(pages: Path) -> None:
    listed = {name for names in GROUPS.values() for name in names}
    assert {path.stem for path in pages.glob("*.md")} - {"index"} == listed


def test_the_site_has_its_configuration_with_the_styles_and_scripts_that_it_names() -> None:
    config = (CONFIG / "conf.py").read_text(encoding="utf-8")
    named = re.findall(r'^html_\w+_files = \["(\S+)"\]$', config, re.MULTILINE)
    assert len(named) > 1 and [name for name in named if not (CONFIG / "static" / name).is_file()] == []


def test_a_link_whose_text_is_wrapped_leads_where_the_site_has_it(pages: Path) -> None:
    assert re.search(r"\]\((?:\.\./|docs/)", "".join(path.read_text("utf-8") for path in pages.glob("*.md"))) is None


# ---- The table of docs/python.md names parameters as the code has them, so that what it shows can be given by
# name.

ROWS = [line.split(" | ", 1) for line in (SOURCE_DIR / "docs" / "python.md").read_text(encoding="utf-8").splitlines()
        if line.startswith("| `")]
CALL = re.compile(r"`(?:\w+\.)?(\w+)\((\w[^`]*)\)`")
MAKERS = {"plant.sensors": laconic.Sensors, "plant.step_derivatives": laconic.StepDerivatives}


def calls() -> Iterator[tuple[str, list[str], list[str]]]:
    """Each call of a row, the names that it gives, and those that the code has."""
    for head, text in ROWS:
        named = re.findall(r"`([\w.]+)", head)
        if not named or not (hasattr(laconic, named[0]) or named[0] in MAKERS):
            continue
        owner = MAKERS.get(named[0]) or getattr(laconic, named[0])
        if owner is laconic.simulate:
            owner = laconic.Trajectory
        for part, holder in ((head, laconic.Plant if named[0] in MAKERS else laconic), (text, owner)):
            for name, given in CALL.findall(part):
                if found := getattr(holder, name, None):
                    words = [each.partition("=")[0].strip() for each in given.split(",")]
                    parameters = [*inspect.signature(found).parameters]
                    yield f"{name}({given})", [word for word in words if word.isidentifier()], parameters


@pytest.mark.parametrize("call, given, known", [*calls()], ids=lambda part: part if isinstance(part, str) else "-")
def test_a_call_on_the_page_names_parameters_of_the_code(call: str, given: list[str], known: list[str]) -> None:
    assert [name for name in given if name not in known] == [], call


def test_the_page_shows_calls_of_vehicles_plants_and_their_derivatives() -> None:
    shown = " ".join(call for call, given, _ in calls() if given)
    assert all(f"{name}(" in shown for name in ("derivative", "linearise", "run", "tangent", "adjoint", "make_fmu",
                                                "wheel_torques", "change", "predict", "Batch", "columns_of"))
