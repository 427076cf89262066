"""`laconic replay` of what `laconic simulate` wrote: no map is needed, and it lists what it compared."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run


@pytest.fixture
def written(tmp_path, capsys) -> Path:
    """Outputs and inputs of s1."""
    path = tmp_path / "run.csv"
    assert run(["simulate", "s1", "--out", str(path), "--inputs"]) == 0
    capsys.readouterr()
    return path


def compared(capsys, *arguments: object) -> dict:
    assert run(["replay", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def scene_without_inputs(folder: Path, old: str = "", new: str = "") -> Path:
    """s1 that nothing drives; with a number changed."""
    text = scene_path("s1").read_text().replace(old, new)
    head, _, tail = text.partition("[[input]]")
    path = folder / "changed.toml"
    path.write_text(head + tail[tail.rindex("[run]"):])
    return path


def test_the_inputs_of_a_run_give_the_run_again(written, tmp_path, capsys):
    found = compared(capsys, written, scene_without_inputs(tmp_path))
    assert found["inputs"] == [f"voltage_V[{wheel}]" for wheel in (1, 2, 3)]
    assert found["inputs_between_rows"] == "held"
    assert found["rows"] == 1001 and found["end_s"] == 10.0 and found["left_out"] == []
    names = [each["signal"] for each in found["compared"]]
    assert names[:3] == ["nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]"] and "energy_J" in names
    assert max(each["largest_difference"] for each in found["compared"]) == 0.0


def test_another_vehicle_differs_and_the_report_names_where(written, tmp_path, capsys):
    scene = scene_without_inputs(tmp_path)
    text = scene.read_text()
    mass = next(line for line in text.splitlines() if line.startswith("mass_kg"))
    scene.write_text(text.replace(mass, "mass_kg = 12.5"))
    found = {each["signal"]: each for each in compared(capsys, written, scene)["compared"]}
    worst = found["nu_rad_per_s[1]"]
    assert 0.0 < worst["root_mean_square"] < worst["largest_difference"] < worst["largest_value"]
    assert 0.0 < worst["at_s"] <= 10.0


def test_the_report_lists_what_was_compared(written, tmp_path, capsys):
    table = [line.split(",") for line in written.read_text().splitlines()]
    moved = [["time_s", *table[0][1:], "battery_V"], *([repr(float(t) + 5.0), *rest, "12.6"] for t, *rest in table[1:])]
    written.write_text("\n".join(map(",".join, moved)))
    assert run(["replay", str(written), "s1", "--out", str(tmp_path / "new" / "found")]) == 0
    text = capsys.readouterr().out
    assert "1001 rows, 5 to 15 s" in text
    assert "Inputs from the file, held from each row to the next: voltage_V[1], voltage_V[2], voltage_V[3]." in text
    assert "no signals of this vehicle: battery_V" in text
    assert "| energy_J | 0 |" in text
    made = tmp_path / "new" / "found"
    assert sorted(path.name for path in made.iterdir()) == ["replay.png", "report.json", "report.md"]


def test_a_file_without_inputs_is_compared_with_the_scenes_own(tmp_path, capsys):
    path = tmp_path / "run.csv"
    assert run(["simulate", "paper_caster", "--out", str(path)]) == 0
    capsys.readouterr()
    found = compared(capsys, path, "paper_caster")
    assert found["inputs"] == [] and found["inputs_between_rows"] == "of the scene"
    assert max(each["largest_difference"] for each in found["compared"]) == 0.0


def test_inputs_that_vary_are_linear_between_rows(tmp_path, capsys):
    scene, path = tmp_path / "sine.toml", tmp_path / "run.csv"
    text = scene_without_inputs(tmp_path).read_text()
    scene.write_text(text + '\n[[input]]\nsignal = "voltage_V[1]"\nkind = "sine"\namplitude = 6\nfrequency_Hz = 0.5\n')
    assert run(["simulate", str(scene), "--out", str(path), "--inputs"]) == 0
    capsys.readouterr()
    found = compared(capsys, path, scene)
    assert found["inputs_between_rows"] == "linear"
    for each in found["compared"]:
        assert each["largest_difference"] <= 1e-3 * max(each["largest_value"], 1e-2), each


def test_what_only_a_vehicle_with_friction_shows_is_compared_too(tmp_path, capsys):
    text, path, out = scene_path("skid_steer").read_text(), tmp_path / "skid.toml", tmp_path / "run.csv"
    signals = ["slip_along_m_per_s", "contact_state", "motor_current_A[2]", "supply_voltage_V", "slip_loss_J"]
    path.write_text(text.replace("[run]", f"[outputs]\nsignals = {signals}\n[run]"))
    assert run(["simulate", str(path), "--out", str(out), "--inputs"]) == 0
    capsys.readouterr()
    found = compared(capsys, out, path)
    assert found["left_out"] == []
    assert len(found["compared"]) == 4 + 4 + 3
    assert max(each["largest_difference"] for each in found["compared"]) == 0.0


HEAD = "time_s,x_m,voltage_V[1]\n"
BAD = {
    "no rows": (HEAD + "0,0,0\n", "has 1 rows"),
    "time that stands": (HEAD + "0,0,0\n1,0,0\n1,0,0\n", "line 4: time_s does not grow"),
    "no number": (HEAD + "0,0,0\n1,x,0\n", "line 3: x_m is 'x'"),
    "NaN": (HEAD + "0,0,0\n1,0,nan\n", "line 3: voltage_V[1] is 'nan'"),
    "a row too short": (HEAD + "0,0,0\n1,0\n", "line 3: has 2 columns, the first line 3"),
    "two columns of one name": ("time_s,x_m,x_m\n0,0,0\n1,0,0\n", "two columns 'x_m'"),
    "nothing to compare": ("time_s,battery\n0,0\n1,0\n", "no column to compare"),
    "between steps": (HEAD + "0,0,0\n0.0015,0,0\n", "line 3: time_s 0.0015 s falls inside a step of 0.001 s"),
    "late, without inputs": ("time_s,x_m\n2,0\n3,0\n", "begins at 2 s"),
}


@pytest.mark.parametrize("text, words", BAD.values(), ids=BAD)
def test_a_file_that_cannot_be_replayed_is_one_line(text, words, tmp_path, capsys):
    path = tmp_path / "run.csv"
    path.write_text(text)
    assert run(["replay", str(path), "s1"]) == 2
    printed = capsys.readouterr()
    assert words in printed.err and str(path) in printed.err and printed.err.count("\n") == 1 and printed.out == ""


def test_a_folder_of_such_files_is_driven_by_their_voltages_as_one_file_is(tmp_path, capsys):
    runs = tmp_path / "runs"
    runs.mkdir()
    for name in ("a", "b"):
        assert run(["simulate", "turtlebot3_burger", "--out", str(runs / f"{name}.csv"), "--inputs"]) == 0
    wrong, text = tmp_path / "wrong.toml", scene_path("turtlebot3_burger").read_text()
    gain = next(line for line in text.splitlines() if line.startswith("motor_gain_Nm_per_V"))
    wrong.write_text(text.replace(gain, "motor_gain_Nm_per_V = 0.1"))
    capsys.readouterr()
    assert [each["path_error"] < 1e-6 for each in compared(capsys, runs, "turtlebot3_burger")["runs"]] == [True, True]
    for given in ([runs], [runs / "a.csv", runs / "b.csv"]):  # wheel speeds would hide the motors' error
        assert all(each["path_error"] > 0.02 for each in compared(capsys, *given, wrong)["runs"])
    rolled = compared(capsys, runs, wrong, "--inputs", "wheel-speeds")
    assert all(each["path_error"] < 1e-3 for each in rolled["runs"])


def test_a_scene_before_the_log_is_told_its_place(written, tmp_path, capsys):
    scene = scene_without_inputs(tmp_path)
    assert run(["replay", str(scene), str(written)]) == 2
    assert capsys.readouterr().err == f"laconic: {scene}: is a scene, which comes last: laconic replay LOG... SCENE\n"


def test_friction_cannot_be_fitted_without_currents(written, capsys):
    assert run(["replay", str(written), "s1", "--fit", str(written)]) == 2
    assert "--fit: needs measured currents" in capsys.readouterr().err


def test_the_step_that_a_refusal_advises_is_taken_for_rows_at_30_a_second(tmp_path, capsys):
    path, scene = tmp_path / "run.csv", tmp_path / "scene.toml"
    path.write_text("time_s,x_m,voltage_V[1]\n" + "".join(f"{k / 30!r},0,0\n" for k in range(3000)))
    scene.write_text(scene_without_inputs(tmp_path).read_text())
    assert run(["replay", str(path), str(scene)]) == 2
    advised = re.search(r"a step of (\S+) s would do", capsys.readouterr().err)[1]
    old = next(line for line in scene.read_text().splitlines() if line.startswith("step_s"))
    scene.write_text(scene.read_text().replace(old, f"step_s = {advised}"))
    assert 0.0 < float(advised) <= 0.001
    assert run(["replay", str(path), str(scene)]) == 0
