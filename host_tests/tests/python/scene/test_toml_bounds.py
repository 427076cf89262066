"""A TOML file that would take gigabytes to parse is refused before, in one line; usual files are not."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from laconic.can.play import map_file
from laconic.errors import BadInput
from laconic.robot.logs.column_map import read_map
from laconic.scene import read_scene
from laconic.scene.scene_tables import scene_tables
from laconic.scene.table import entries_of, read_toml
from laconic.scene.toml_bounds import MOST_KEYS, MOST_NESTED, MOST_PARTS, check_bounds

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

DEEP = 100_000
TOO_MUCH = {
    "a dotted key": (".".join("a" * DEEP) + " = 1", "line 1 has a key of more than"),
    "a dotted key of quoted parts": (" . ".join(['"a"', "'b'"] * DEEP) + " = 1", "line 1 has a key of more than"),
    "a dotted key in an inline table": ("x = 1\ny = { " + ".".join("a" * DEEP) + " = 1 }", "line 2 has a key of more"),
    "a dotted key behind strings": ("x = \"a\\\"'#\"\ny = '#'\nz = '''\n'\"''' # '\n" + ".".join("a" * DEEP) + " = 1",
                                    "line 5 has a key of more than"),
    "the name of a table": ("[" + ".".join("a" * DEEP) + "]", "line 1 has a key of more than"),
    "the name of an array of tables": ("[[" + ".".join("a" * DEEP) + "]]", "line 1 has a key of more than"),
    "lists": ("x = " + "[" * DEEP, "line 1 nests lists or tables too deeply"),
    "inline tables": ("x = " + "{a=" * DEEP, "line 1 nests lists or tables too deeply"),
    "keys": ("".join(f"k{number} = 1\n" for number in range(MOST_KEYS + 1)), f"line {MOST_KEYS + 1} begins key"),
    "tables": ("[[a]]\n" * (MOST_KEYS + 1), f"line {MOST_KEYS + 1} begins key"),
}
READERS: dict[str, Callable[[Path], Any]] = {
    "a scene": read_scene, "a scene's tables": scene_tables, "a map of logs": read_map,
    "a map of a bus": lambda path: map_file.read_map(path, 4)}


# The readers share one function: what costs seconds to read is read by the first alone, at night by all.
@pytest.mark.parametrize("text, message, reader", [
    pytest.param(*case, reader, id=f"{name}-{who}",
                 marks=[pytest.mark.nightly] if name in ("keys", "tables") and k > 0 else [])
    for name, case in TOO_MUCH.items() for k, (who, reader) in enumerate(READERS.items())])
def test_every_reader_refuses_what_would_fill_the_memory(tmp_path: Path, reader: Callable[[Path], Any], text: str,
                                                         message: str) -> None:
    path = tmp_path / "deep.toml"
    path.write_text(text)
    tracemalloc.start()
    try:
        with pytest.raises(BadInput) as refused:
            reader(path)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert f"{path}: {message}" in str(refused.value) and str(refused.value).endswith("give the path of another file")
    assert most < 40 * 2**20


def test_a_file_that_is_too_long_is_not_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    with path.open("wb") as file:
        file.truncate(10**9)
    with pytest.raises(BadInput, match="has more than 16 MiB, which no scene needs"):
        read_toml(path)


@pytest.mark.parametrize("text", [
    ".".join(f"k{number}" for number in range(MOST_PARTS)) + " = 1.5e-3",
    "x = " + "[" * MOST_NESTED + "]" * MOST_NESTED,
    "x = \"" + "a." * 100 + "\"",
    "x = '" + "[" * 100 + "'",
    'x = """\n' + "[." * 100 + '\\""" . [ " ""\n"""\ny = 1',
    "x = '''\n" + "{." * 100 + "\n'''",
    "# " + "a." * 100 + "\nx = [\n  1.5, # [[[[[[[[[[\n  2.5,\n]",
    "t = [" + "1.5, " * 1000 + "]",
    'x = """a"""""\ny.z = 1',
    r'x = "\\"' + "\ny.z = 1",
])
def test_a_usual_text_is_within_the_bounds_and_read_as_before(text: str) -> None:
    assert entries_of(text) == tomllib.loads(text)


def test_a_string_without_an_end_is_left_to_the_parser() -> None:
    for text in ('x = "a', "x = 'a", 'x = """a', "x = '''a", 'x = "a\\', 'x = "a\ny.z = 1'):
        check_bounds(text)
        with pytest.raises(tomllib.TOMLDecodeError):
            entries_of(text)


def test_a_number_of_thousands_of_digits_is_named_in_our_own_words(tmp_path: Path) -> None:
    path = tmp_path / "digits.toml"
    path.write_text("x = " + "9" * 5000)
    with pytest.raises(BadInput, match="holds a number of thousands of digits; give numbers as people write them"):
        read_toml(path)
