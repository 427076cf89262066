"""Libraries read files in this process, which takes a tenth of the time; test_import_bounds has their own one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from laconic.robot.importer import mjcf, xacro_expansion
from laconic.robot.importer.bounded import Reader


def direct(library: object, call: Callable[..., Any], path: Path, *more: Any) -> Any:
    return call(path, *more)


def asked(reader: Reader, call: Callable[..., Any], *arguments: Any) -> Any:
    return call(*arguments)


@pytest.fixture(autouse=True)
def in_this_process(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if not request.module.__name__.endswith("test_import_bounds"):
        monkeypatch.setattr(mjcf, "bounded", direct)
        monkeypatch.setattr(xacro_expansion, "bounded", direct)
        monkeypatch.setattr(Reader, "ask", asked)
