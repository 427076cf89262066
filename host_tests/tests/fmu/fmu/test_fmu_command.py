"""laconic fmu: what it writes to, what it prints, and which warnings come before the work."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.core.grip import percent


@pytest.mark.parametrize("options", ["--fmi 3", "--fmi 2", "--fmi 2 --ssp"])
@pytest.mark.parametrize("as_json", [False, True])
def test_a_device_takes_the_archive_as_it_is(options: str, as_json: bool, capsys) -> None:
    assert run(["fmu", "robotino2", *options.split(), "-o", "/dev/null", *(["--json"] if as_json else [])]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    if as_json:
        assert json.loads(printed.out)["bytes"] is None
    else:
        assert printed.out == "wrote /dev/null: Festo Robotino 2, 3 wheels\n"


@pytest.mark.parametrize(("given", "ending"), [("--fmi 3 -o x.zip", ".fmu"), ("--fmi 3 -o x.ssp", ".fmu"),
                                               ("--fmi 2 --ssp -o x.zip", ".ssp"), ("--fmi 2 --ssp -o x.fmu", ".ssp")])
def test_the_ending_that_is_offered_is_the_one_that_is_taken(
        given: str, ending: str, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["fmu", "robotino2", *given.split()]) == 2
    assert capsys.readouterr().err.endswith(f"choose a name that ends in {ending}\n")
    assert list(tmp_path.iterdir()) == []


def test_a_scene_in_single_precision_gets_the_warning_that_fmus_compute_in_double(tmp_path: Path, capsys) -> None:
    path = tmp_path / "small.toml"
    path.write_text(scene_path("robotino2").read_text().replace("[run]", '[run]\nreal = "single"'))
    assert run(["fmu", str(path), "--fmi", "3", "-o", str(tmp_path / "x.fmu"), "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == f'laconic: warning: {path}: run.real: is "single", but FMUs compute in double precision\n'
    found = json.loads(printed.out)
    assert (found["real"], found["scene_real"]) == ("double", "single")
    assert run(["fmu", "robotino2", "--fmi", "3", "-o", str(tmp_path / "x.fmu")]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("count", "of", "shown"), [
    (100, 100, "100 %"), (1, 3, "33.3 %"), (9999, 10000, "over 99.9 %"), (1, 1000, "0.1 %"), (99, 100, "99 %")])
def test_a_share_is_shown_as_people_write_it(count: int, of: int, shown: str) -> None:
    assert percent(count, of) == shown


@pytest.mark.parametrize("key", ["axle_rad", "roller_rad"])
def test_an_angle_too_large_to_have_a_direction_is_refused_by_its_name(key: str, tmp_path: Path, capsys) -> None:
    wheel = {"axle_rad": "0.1", "roller_rad": "1.5"} | {key: "1e308"}
    text = scene_path("robotino2").read_text()
    path = tmp_path / "x.toml"
    first = text.index("[[vehicle.wheel]]")
    after = text.index("[", first + len("[[vehicle.wheel]]"))
    lines = "\n".join(f"{name} = {value}" for name, value in wheel.items())
    path.write_text(f'{text[:first]}[[vehicle.wheel]]\nkind = "omni"\nx_m = 0.1\ny_m = 0.0\n{lines}\n\n{text[after:]}')
    assert run(["simulate", str(path)]) == 2
    assert f"vehicle.wheel[1].{key}: a result leaves the range" in capsys.readouterr().err
