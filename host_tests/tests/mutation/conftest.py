"""A small project to mutate."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from laconic.mutation.compiled import Compiled
from laconic.mutation.programs import Family, Program, Unit
from laconic.mutation.trial import Trials


@pytest.fixture
def trials_of(tmp_path, monkeypatch):
    """Of texts: the library's files, and the test programs', of one file each."""
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")

    def make(library: dict[str, str], tests: dict[str, str]) -> tuple[Trials, Path]:
        sources = tmp_path / "sources"
        (sources / "core_c").mkdir(parents=True)
        for file, text in (library | tests).items():
            (sources / "core_c" / file).write_text(text)
        for module in ("compiled", "programs", "results"):
            monkeypatch.setattr(f"laconic.mutation.{module}.SOURCE_DIR", sources)
        monkeypatch.setattr("laconic.mutation.compiled.FOLDERS", ("core_c",))
        units = {}
        for file in (each for each in library | tests if each.endswith(".c")):
            name = Path(file).stem
            unit = Unit(sources / "core_c" / file, name, ("gcc", "-O2", "-fPIC"), tmp_path, tmp_path / f"{name}.o")
            assert unit.compile(sources, unit.object).returncode == 0
            units[file] = unit
        empty = tmp_path / "liblaconic_unity.a"
        empty.write_text("/* a linker script */\n")
        monkeypatch.setattr("laconic.mutation.programs.unity", lambda: empty)
        folder = tmp_path / "double"
        names = {file: f"{Path(file).stem}_double" for file in tests}
        programs = [Program(name, [units[file]], folder / name) for file, name in names.items()]
        family = Family("double", folder, [unit for file, unit in units.items() if file in library], programs)
        family.link()
        family.check()
        monkeypatch.setattr("laconic.mutation.programs.PATIENCE_S", 0.5)
        return Trials(Compiled([family], tmp_path)), sources

    return make
