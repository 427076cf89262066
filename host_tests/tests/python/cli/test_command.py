"""The command line as a whole: commands are found, explain themselves, and end with the status that they promise."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from laconic.base.paths import build_dir, built, scene_path
from laconic.base.progress import each_minute, forecast
from laconic.cli.main import commands, run
from laconic.core.grip import Grip, GripEvent
from laconic.errors import BadInput

NAMES = ("demo", "simulate", "verify", "fmu", "derive")


@pytest.mark.parametrize("name", NAMES)
def test_every_command_is_found_and_explains_itself(name, capsys):
    assert name in commands.list_commands(None)
    assert run([name, "--help"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"Usage: laconic {name}")
    assert len(text.splitlines()) > 5


@pytest.mark.parametrize("columns", ["80", "200"])
def test_no_line_of_any_help_is_longer_than_a_page(columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    for name in commands.list_commands(None):
        run([name, "--help"])
        lines = capsys.readouterr().out.splitlines()
        assert len(max(lines, key=len)) <= 95, name


def test_what_every_command_writes_is_named_by_one_letter():
    for name in commands.list_commands(None):
        for option in commands.get_command(None, name).params:
            assert "-o" in option.opts or not {"--out", "--output"} & {*option.opts}, name
            assert "--out" in option.opts or "-o" not in option.opts, name


def test_help_lists_the_commands(capsys):
    assert run(["--help"]) == 0
    text = capsys.readouterr().out
    assert all(f"  {name} " in text for name in NAMES)
    assert "..." not in text.partition("Commands:")[2]  # no summary is cut off


def test_version(capsys):
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("laconic ")


def test_no_command_is_bad_input(capsys):
    assert run([]) == 2
    assert "Usage:" in capsys.readouterr().err


def loaded_by(*arguments: str, status: int = 0) -> set[str]:
    """The modules that a command line loads, in a process of its own."""
    script = (f"import sys; from laconic.cli.main import run; assert run({[*arguments]!r}) == {status}; "
              "print(*sys.modules)")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


HEAVY = {"scipy", "sympy", "matplotlib", "fmpy"}


@pytest.mark.parametrize("arguments, status", [(["--help"], 0), (["--version"], 0), (["simulat"], 2), (["--hlep"], 2)])
def test_what_concerns_no_command_loads_no_command(arguments, status):
    loaded = loaded_by(*arguments, status=status)
    assert not loaded & {*HEAVY, "numpy", "rich", "can"}
    assert not any(name.startswith("laconic.cli.commands.") for name in loaded)


def test_a_command_that_explains_itself_loads_no_heavy_library():
    script = ("import sys; from laconic.cli.main import commands, run; "
              "assert all(run([name, '--help']) == 0 for name in commands.list_commands(None)); print(*sys.modules)")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not HEAVY & set(done.stdout.splitlines()[-1].split())


def test_a_command_loads_no_more_than_it_needs():
    slow_to_start = {"pycparser", "rich", "urllib.request", "importlib.metadata", "numpy.ma"}
    assert not loaded_by("simulate", "s1") & {*HEAVY, *slow_to_start, "can"}


def test_what_is_not_built_is_reported_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setenv("LACONIC_BUILD_DIR", str(tmp_path))
    assert build_dir() == tmp_path
    with pytest.raises(BadInput, match="cmake --workflow --preset demo"):
        built("lib/liblaconic_double.so")


def test_a_scene_is_found_by_name_and_by_path(tmp_path):
    own = tmp_path / "s1.toml"
    own.write_text("")
    assert scene_path("s1").name == "s1.toml"
    assert scene_path(own) == own
    with pytest.raises(BadInput, match="no such scene"):
        scene_path("somewhere/s1")


@pytest.mark.nightly
def test_demo_of_one_scene_writes_pictures_and_figures(tmp_path, capsys):
    assert run(["demo", "paper_differential_drive", "--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    (scene,) = answer["scenes"]
    assert scene["passed"]
    assert scene["steps"] >= 10_000
    assert scene["same_bits"] == {"FMI 2": "", "FMI 3": "", "node": ""}
    assert min(scene["compared"].values()) >= 1000
    assert (tmp_path / "paper_differential_drive.png").read_bytes().startswith(b"\x89PNG")
    assert len((tmp_path / "errors.csv").read_text().splitlines()) == 1 + len(scene["points"])
    best = min(point["error_nu"] for point in scene["points"] if point["error_nu"] is not None)
    assert best < 1e-11
    assert scene["floor"] < 1e-11


def test_demo_fails_when_a_participant_differs(tmp_path, capsys, monkeypatch):
    import laconic.tools.demo.main_job as main_job

    honest = main_job.rows_of

    def bent(who, scene, folder):
        rows = honest(who, scene, folder)
        if who == "node":
            rows.rows[5, 0] += 1e-12
        return rows

    monkeypatch.setattr(main_job, "rows_of", bent)
    monkeypatch.setattr(main_job, "measure_all", lambda scene, target: [])
    monkeypatch.setattr(main_job, "draw_scene", lambda scene, result, out: None)
    assert run(["demo", "s1", "--out", str(tmp_path), "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert "nu_rad_per_s[1] after step 60" in answer["scenes"][0]["same_bits"]["node"]


def test_demo_cannot_write_where_a_file_is(tmp_path, capsys):
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert run(["demo", "s1", "--out", str(blocked / "inside")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


# ---- What a caller of the command line sees of long work, closed streams and a home that cannot be written.

@pytest.mark.parametrize(("per_call_s", "words"), [(0.6, "about 14 days"), (1e-9, "")])
def test_long_work_is_foretold_once(capsys, per_call_s, words):
    now = [0.0]
    advance = forecast("robot", 2e6, lambda: now[0])
    for _ in range(5):
        now[0] += per_call_s
        advance(1)
    err = capsys.readouterr().err
    assert (words in err) and err.count("\n") == bool(words)


def test_long_work_says_each_minute_how_far_it_is(capsys):
    now = [0.0]
    advance = each_minute("report", 40, lambda: now[0])
    for step in range(1, 11):
        now[0] += 30.0
        advance(1, what="extremes" if step == 6 else None)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 5
    assert lines[0] == "laconic: report: 2 of 40 after 60 seconds, about 19 minutes left"
    assert lines[-1] == "laconic: report, extremes: 10 of 40 after 5 minutes, about 15 minutes left"


@pytest.mark.skipif(os.name == "nt", reason="closes streams as a Unix shell does")
@pytest.mark.parametrize("closed", ["<&- >&- 2>&-", "<&- 2>&-"])
def test_closed_streams_end_in_order(closed):
    call = f'"{sys.executable}" -m laconic simulate s1 {closed}'
    assert subprocess.run(call, shell=True, stdout=subprocess.DEVNULL).returncode == (2 if ">&- 2" in closed else 0)


def test_a_home_that_cannot_be_written_is_no_matter_for_stderr(tmp_path):
    (tmp_path / "file").write_text("")
    env = os.environ | {"MPLCONFIGDIR": str(tmp_path / "file" / "below"), "HOME": "/nowhere"}
    done = subprocess.run([sys.executable, "-m", "laconic", "simulate", "s1", "--plot", str(tmp_path / "a.png")],
                          env=env, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_worst_slip_is_shown_with_its_margin_and_all_of_a_run_is_100_percent():
    first, worst = (GripEvent(t, 0, "wheel 1", needed, has, 1.0, has - needed)
                    for t, needed, has in ((0.0, 659.0, 330.0), (1.0, 338.0, 0.0)))
    text = Grip(0.5, 3, 3, 0, first, worst, None, None).warning()
    assert "margin -329 N; at worst margin -338 N" in text and "100 % of the run" in text
