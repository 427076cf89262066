"""Spoilt files are read or refused by one line; what fuzzes them notices when they are not; a search with a seed is
the same each time."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from laconic.soak._fuzzing import files, kept
from laconic.soak._fuzzing.file_readers import FILE_TARGETS, FileTarget
from laconic.soak._fuzzing.spoil import Spoiler, lines_of
from laconic.soak._fuzzing.targets import targets_by_name

from laconic.base.paths import SOURCE_DIR, built
from laconic.errors import BadInput
from laconic.scene.table import entries_of

INPUTS = {"scenes": 120, "column-maps": 300, "dbc-maps": 150, "dbc": 60}
GOOD = 'name = "a"\n[vehicle]\nmass_kg = 1.5\n[[vehicle.wheel]]\nat = [1, 2]\n'


@pytest.fixture(autouse=True)
def _elsewhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(files, "build_dir", lambda: tmp_path)


@pytest.mark.parametrize("name", FILE_TARGETS)
def test_spoilt_files_are_read_or_refused_by_one_line(name: str) -> None:
    found, _ = files.fuzz_files(name, float("inf"), 1, lambda _: None, INPUTS[name])
    assert not found.crash, Path(f"{found.crash}.txt").read_text(encoding="utf-8")
    assert found.executions == INPUTS[name]


def raising(error: Exception) -> Callable[[Path], None]:
    def use(_: Path) -> None:
        raise error
    return use


@pytest.mark.parametrize("error, said", [
    (ZeroDivisionError("1/0"), "ZeroDivisionError"), (BadInput("spoilt.toml: is wrong"), "says not what to do"),
    (BadInput("is wrong; give another"), "does not name the file"),
    (BadInput("spoilt.toml: is " + "long " * 500 + "; give less"), "longer than")])
def test_what_is_no_refusal_by_one_line_is_found_and_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
                                                          error: Exception, said: str) -> None:
    good = tmp_path / "good.toml"
    good.write_text(GOOD, encoding="utf-8")
    monkeypatch.setitem(FILE_TARGETS, "scenes", FileTarget(lambda: [good], raising(error)))
    found, _ = files.fuzz_files("scenes", float("inf"), 1, lambda _: None, 3)
    assert found.executions == 1 and Path(found.crash).read_text(encoding="utf-8") == GOOD
    assert said in Path(f"{found.crash}.txt").read_text(encoding="utf-8")


def test_a_file_that_reaches_new_lines_is_kept_and_others_are_not(tmp_path: Path) -> None:
    files.fuzz_files("column-maps", float("inf"), 1, lambda _: None, INPUTS["column-maps"])
    kept_texts = sorted((tmp_path / "fuzz/column-maps").glob("kept-*"))
    assert 0 < len(kept_texts) < INPUTS["column-maps"] / 3


def test_the_same_seed_spoils_alike_and_tables_are_written_as_they_are_read() -> None:
    one, other = ([Spoiler(seed).spoilt(GOOD, GOOD) for _ in range(3)] for seed in (5, 5))
    assert one == other and Spoiler(6).spoilt(GOOD, GOOD) != one[0]
    tables = {"name": "a\n\"", "vehicle": {"mass_kg": 1.5, "wheel": [{"at": [1, {"b c": True}]}]}}
    assert entries_of("\n".join(lines_of(tables))) == tables


def test_the_search_of_continuous_integration_is_the_same_each_time(tmp_path: Path) -> None:
    target, program = targets_by_name()["moteus"], built("fuzz/fuzz_moteus")
    if b"libFuzzer" not in program.read_bytes():
        pytest.skip("no clang with libFuzzer")
    found = []
    for folder in (tmp_path / "one", tmp_path / "another"):
        subprocess.run(["cmake", f"-DPROGRAM={program}", f"-DBYTES={target.most_bytes}", "-DRUNS=8000",
                        f"-DFRESH={folder}", f"-DCORPUS={target.corpus}", "-P",
                        SOURCE_DIR / "firmware_stub/fuzz/run_fuzzer.cmake"], check=True, capture_output=True)
        found.append(sorted(path.name for path in folder.iterdir()))
    assert found[0] == found[1] and len(found[0]) > len(list(target.corpus.iterdir()))


def test_the_page_has_a_row_for_each_target_which_no_result_contradicts() -> None:
    table = kept.PAGE.read_text(encoding="utf-8").split(kept.BEGIN)[1].split(kept.END)[0]
    rows = {cells[1].strip(" `"): [cell.strip().replace(",", "") for cell in cells[2:-1]]
            for cells in (line.split("|") for line in table.splitlines() if line.startswith("| `"))}
    known = targets_by_name()
    assert list(rows) == [*known, *FILE_TARGETS]
    for name, target in known.items():
        rate, wanted, executions, edges, inputs = map(int, rows[name])
        assert wanted == target.wanted_per_s and inputs == len(list(target.corpus.iterdir()))
        assert rate > 0 and executions >= rate and edges > 50
