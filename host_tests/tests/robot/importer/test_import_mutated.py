"""Two hundred broken files: each gives a scene with wheels, or one line; none a traceback or the words of one."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mutated_files import ROBOTS, mutated

from laconic.errors import BadInput
from laconic.robot.importer import Answers, import_robot, mjcf, xacro_expansion

FILES, AT_ONCE = 200, 20
LONGEST_S = 20.0
OF_PYTHON = re.compile(r"object has no|Traceback|NoneType|invalid literal|could not convert|out of range|unpack|"
                       r"subscriptable|\b[A-Z]\w+Error\b|unexpected [A-Z]")


def direct(library: object, call: Callable[..., Any], path: Path, *more: Any) -> Any:
    """In this process: two hundred others would take minutes."""
    return call(path, *more)


def outcome(path: Path) -> tuple[tuple[str, ...], str]:
    """The wheels, or why there are none."""
    try:
        return import_robot(path, Answers(rollers={"": "none"}, friction_coefficient=0.5)).wheels, ""
    except BadInput as refused:
        return (), str(refused)


@pytest.mark.parametrize("first", range(0, FILES, AT_ONCE))
def test_a_broken_file_is_a_scene_or_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, first: int) -> None:
    monkeypatch.setattr(mjcf, "bounded", direct)
    monkeypatch.setattr(xacro_expansion, "bounded", direct)
    for seed in range(first, first + AT_ONCE):
        name, text = mutated(seed)
        (tmp_path / name).write_text(text, encoding="utf-8")
        began = time.process_time()
        wheels, refusal = outcome(tmp_path / name)
        assert bool(wheels) != bool(refusal), seed
        assert not refusal or refusal.startswith(("--", f"{tmp_path / name}: ")), (seed, refusal)
        assert not OF_PYTHON.search(refusal), (seed, refusal)
        assert time.process_time() - began < LONGEST_S, seed


def test_the_files_are_broken_and_most_kinds_of_robots_are_among_them() -> None:
    whole = {text for _, text in ROBOTS}
    files = [mutated(seed) for seed in range(FILES)]
    assert sum(text in whole for _, text in files) < FILES // 20
    assert {name for name, _ in files} == {name for name, _ in ROBOTS}
