"""What a caller of the command line sees of long work, closed streams and a home that cannot be written."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from laconic.base.progress import each_minute, forecast
from laconic.core.grip import Grip, GripEvent


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
