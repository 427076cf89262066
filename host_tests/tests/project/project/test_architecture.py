"""docs/architecture.md is true of the tree, and every page can be found."""

from __future__ import annotations

import re

from laconic.base.paths import SOURCE_DIR as ROOT

PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")


def test_every_folder_that_the_page_names_is_there() -> None:
    cells = re.findall(r"^\| (`.*?) \|", PAGE.split("# From a vehicle")[0], re.MULTILINE)
    named = {name for cell in cells for name in re.findall(r"`(\S+)`", cell)}
    assert {"core_c/src", "python/laconic", "host_tests", "scenes"} <= named
    assert [name for name in named if not (ROOT / name).is_dir()] == []


def test_each_function_on_the_way_of_a_voltage_is_defined_in_its_file() -> None:
    rows = re.findall(r"^\| `(\S+)` \| `(\w+)` \|", PAGE, re.MULTILINE)
    assert len(rows) > 3
    for path, function in rows:
        body = rf"^\w[\w *]*\b{function}\([^;{{]*\) \{{"
        assert re.search(body, (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE), f"{path} has no {function}"


def test_every_file_and_c_name_that_the_page_mentions_exists() -> None:
    parts = ("core_c", "fmu", "firmware_stub", "python", "packaging")
    sources = [path for part in parts for path in (ROOT / part).rglob("*")]
    files = {path.name for path in sources} | {path.name for path in ROOT.iterdir()}
    names = {name.rpartition("/")[2] for name in re.findall(r"`([\w/.]+\.(?:c|h|py|xml|dbc|md))`", PAGE)}
    assert {name for name in names if "NAME" not in name} - files == set()
    in_c = [path.read_text(encoding="utf-8") for path in sources if path.suffix in (".c", ".h")]
    words = set(re.findall(r"\w+", "\n".join(in_c)))
    packages = {path.name for path in ROOT.glob("p*/laconic*")}
    assert set(re.findall(r"`((?:laconic|fmu|fmi\d|LACONIC)_?\w+)`", PAGE)) - words - packages == set()


def test_every_page_can_be_reached_from_the_readme() -> None:
    seen, todo = set(), [ROOT / "README.md"]
    while todo:
        page = todo.pop()
        seen.add(page)
        links = re.findall(r"\]\(([^)#:]+\.md)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
        todo += [target for link in links if (target := (page.parent / link).resolve()) not in seen]
    assert set((ROOT / "docs").glob("*.md")) <= seen
