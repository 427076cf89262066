"""An FMU driven by FMPy has its library closed once: closed twice, the loader writes into memory that was freed."""

from __future__ import annotations

import fmpy.fmi1
import pytest

from laconic.fmu import make_fmu
from laconic.scene import Scene, read_scene
from laconic.tools.demo.fmu_rows import fmu_rows


@pytest.fixture
def closed(monkeypatch) -> list[int]:
    """The handles of the libraries that FMPy has closed."""
    handles: list[int] = []
    monkeypatch.setattr(fmpy.fmi1, "freeLibrary", handles.append)
    return handles


@pytest.fixture(params=[2, 3])
def fmu(request, tmp_path):
    return make_fmu(scene(), tmp_path / "scene.fmu", version=request.param)


def scene() -> Scene:
    return read_scene("s1")


def test_a_run_closes_the_fmus_library_once(fmu, closed):
    fmu_rows(scene(), fmu, 3)
    assert len(closed) == 1


def test_a_run_that_fails_closes_the_fmus_library_once(fmu, closed):
    def interrupt(_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fmu_rows(scene(), fmu, 3, moved=interrupt)
    assert len(closed) == 1
