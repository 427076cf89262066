"""Broken files: each gives a scene with wheels, or one line; none a traceback or the words of one.

The campaign is host_tests/assurance/imports.py; these are its first files."""

from __future__ import annotations

from pathlib import Path

import pytest

from assurance.imports import ROBOTS, broken, campaign

FILES, AT_ONCE = 200, 20


@pytest.mark.parametrize("first", [
    0, AT_ONCE, *(pytest.param(each, marks=pytest.mark.nightly) for each in range(2 * AT_ONCE, FILES, AT_ONCE))])
def test_a_broken_file_is_a_scene_or_one_line(tmp_path: Path, first: int) -> None:
    faults: list[str] = []
    ends = campaign(range(first, first + AT_ONCE), ROBOTS, tmp_path, faults.append)
    assert faults == []
    assert set(ends) == {"scene", "refused"}


def test_the_files_are_broken_and_all_kinds_of_robots_are_among_them() -> None:
    whole = {text for _, text in ROBOTS}
    files = [broken(seed) for seed in range(FILES)]
    assert sum(text in whole for _, text in files) < FILES // 20
    assert {name for name, _ in files} == {name for name, _ in ROBOTS}
    assert files == [broken(seed) for seed in range(FILES)]
