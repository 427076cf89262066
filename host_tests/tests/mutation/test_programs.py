"""The build tree tells what the tests are linked of; one that is not there, or is of other sources, is named."""

from __future__ import annotations

import json

import pytest

from laconic.errors import BadInput
from laconic.mutation.programs import units


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """An empty build tree of the sources in `sources`."""
    monkeypatch.setattr("laconic.mutation.programs.SOURCE_DIR", tmp_path / "sources")
    monkeypatch.setattr("laconic.mutation.programs.build_dir", lambda: tmp_path)
    return tmp_path


def entry(source, tree) -> dict[str, str]:
    return {"file": str(source), "directory": str(tree),
            "command": f"cc -O2 -g -Wall -o core_c/CMakeFiles/test_a.dir/a.c.o -c {source}"}


def test_a_unit_is_compiled_as_the_build_does_but_for_warnings_and_debugging(tree):
    source = tree / "sources/core_c/a.c"
    (tree / "compile_commands.json").write_text(json.dumps([entry(source, tree)]))
    unit, = units()
    assert unit.command[:2] == ("cc", "-O2") and "-g" not in unit.command and "-Wall" not in unit.command
    assert (unit.source, unit.target, unit.object) == (source, "test_a", tree / "core_c/CMakeFiles/test_a.dir/a.c.o")


def test_without_a_build_tree_or_with_one_of_other_sources_it_says_so(tree):
    with pytest.raises(BadInput, match="is not there; build the project"):
        units()
    (tree / "compile_commands.json").write_text(json.dumps([entry(tree / "elsewhere/a.c", tree)]))
    with pytest.raises(BadInput, match="is of other sources than .*sources; name their build tree"):
        units()
