"""docs/architecture.md is true of the tree."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
PAGE = ROOT / "docs/architecture.md"
MOST_FILES = 6  # that a voltage crosses
GENERATED = {"__pycache__", "build"}


def section(title: str) -> str:
    """The text below a heading, up to the next one."""
    return re.split(r"^#+ ", PAGE.read_text(encoding="utf-8").split(f"# {title}\n")[1], flags=re.MULTILINE)[0]


def stations(title: str) -> list[tuple[Path, list[str]]]:
    """The rows of a way: a file and the functions named beside it."""
    rows = re.findall(r"^\| `(\S+)` \| (.*?) \|", section(title), re.MULTILINE)
    return [(ROOT / path, re.findall(r"`(\w+)`", functions)) for path, functions in rows]


def defines(source: Path, function: str) -> bool:
    """Whether the C file has the function's body."""
    body = rf"^\w[\w *]*\b{function}\([^;{{]*\) \{{"
    return re.search(body, source.read_text(encoding="utf-8"), re.MULTILINE) is not None


WAYS = ("From a CAN frame", "From an FMI call")


@pytest.mark.parametrize("title", WAYS)
def test_a_voltage_crosses_few_files_and_each_named_function_stands_in_its_file(title):
    way = stations(title)
    assert 1 < len(way) <= MOST_FILES
    for source, functions in way:
        assert functions
        for function in functions:
            assert defines(source, function), f"{source.relative_to(ROOT)} has no {function}"


@pytest.mark.parametrize("title", WAYS)
def test_on_a_voltages_way_each_function_is_called_from_a_file_named_above(title):
    above = ""
    for source, functions in stations(title):
        assert not above or re.search(rf"\b{functions[0]}\(", above), functions[0]
        above += source.read_text(encoding="utf-8")


def test_every_folder_that_the_page_explains_is_there_and_every_part_is_explained():
    named = {name for cell in re.findall(r"^\| (`.*?) \|", section("Architecture"), re.MULTILINE)
             for name in re.findall(r"`(\S+)`", cell)}
    assert all((ROOT / name).is_dir() for name in named), named
    assert {".ci", "cmake", "docs", "scenes"} <= named
    for part in ("core_c", "firmware_stub", "fmu", "host_tests"):
        inner = {path.name for path in (ROOT / part).iterdir() if path.is_dir() and "." not in path.name}
        assert {name.split("/")[1] for name in named if name.startswith(f"{part}/")} == inner - GENERATED


def test_every_room_of_the_package_has_its_line():
    named = re.findall(r"^\| `(\w+)` \|", section("The rooms of the Python package"), re.MULTILINE)
    assert sorted(named) == sorted(path.parent.name for path in (ROOT / "host_tests/laconic").glob("*/__init__.py"))


def test_every_file_and_name_that_the_page_mentions_exists():
    text = PAGE.read_text(encoding="utf-8")
    folders = [folder for part in ("core_c", "fmu", "firmware_stub", "host_tests/laconic") for folder in
               [ROOT / part, *(path for path in (ROOT / part).rglob("*") if path.is_dir())]] + [ROOT]
    for name in re.findall(r"`([\w/.]+\.(?:c|h|py|xml|dbc|md))`", text):
        assert "NAME" in name or any((folder / name).exists() for folder in folders), name
    for link in re.findall(r"\]\(([^)#]+)\)", text):
        assert (PAGE.parent / link).exists(), link


def test_every_c_name_that_the_page_mentions_stands_in_the_sources():
    sources = [path for part in ("core_c", "fmu", "firmware_stub") for path in (ROOT / part).rglob("*.[ch]")]
    words = set(re.findall(r"\w+", "\n".join(path.read_text(encoding="utf-8") for path in sources)))
    names = re.findall(r"`((?:laconic|fmu|fmi\d|LACONIC)_?\w+)`", PAGE.read_text(encoding="utf-8"))
    packages = {"laconic_fmu", "laconic_build.wire", "laconic_build.page", "laconic_build.c", "laconic_build.wheel",
                "laconic_build.release"}
    assert len(names) > 20 and set(names) - words - packages == set()


def test_every_page_can_be_reached_from_the_readme():
    seen, todo = set(), [ROOT / "README.md"]
    while todo:
        page = todo.pop()
        seen.add(page)
        links = re.findall(r"\]\(([^)#:]+\.md)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
        todo += [target for link in links if (target := (page.parent / link).resolve()) not in seen]
    assert set((ROOT / "docs").glob("*.md")) <= seen
