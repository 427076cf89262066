"""Logs of the rig that are broken, cut off or never closed."""

from __future__ import annotations

import io
import json
import random
from pathlib import Path
from xml.etree import ElementTree

import can
import pytest
from rich.console import Console

from laconic.can.rig.boards import own_node
from laconic.can.rig.choices import LOGS as KNOWN
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.live import View
from laconic.can.rig.logs import read_log
from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.scene import read_scene

SEED, BROKEN = 1, 40
LOGS = [each for each in KNOWN if each != ".mf4"]  # which needs a package that tests do not have
OPEN, VOLTAGE = (ID_BASE + wire()[name].offset for name in ("OPEN", "VOLTAGE"))


def recorded(folder: Path, suffix: str) -> Path:
    """A log of a short run."""
    path = folder / f"run{suffix}"
    assert run(["rig", "s1", "--steps", "40", "--log", str(path)]) == 0
    return path


@pytest.mark.parametrize("suffix", LOGS)
def test_a_broken_log_of_any_kind_is_one_line_and_never_a_traceback(suffix: str, tmp_path: Path,
                                                                    capsys: pytest.CaptureFixture[str]) -> None:
    whole, source, refused = recorded(tmp_path, suffix).read_bytes(), random.Random(SEED), 0
    path = tmp_path / f"broken{suffix}"
    for _ in range(BROKEN):
        data = bytearray(whole)
        for _ in range(source.randrange(1, 8)):
            data[source.randrange(len(data))] = source.randrange(256)
        path.write_bytes(source.choice((data, data[: source.randrange(len(data))], source.randbytes(300))))
        capsys.readouterr()
        status, error = run(["rig", "s1", "--replay", str(path)]), capsys.readouterr().err
        assert status in (0, 1, 2) and error.count("\n") == (status == 2)
        refused += status == 2
    assert refused > BROKEN // 4


def test_a_blf_that_is_cut_off_is_refused_and_not_judged_up_to_the_cut(tmp_path: Path,
                                                                       capsys: pytest.CaptureFixture[str]) -> None:
    path = recorded(tmp_path, ".blf")
    path.write_bytes(path.read_bytes()[:-100])
    assert run(["rig", "s1", "--replay", str(path)]) == 2
    assert "is cut off" in capsys.readouterr().err


def test_a_log_that_was_never_closed_fails_the_verdict_about_the_log_alone(tmp_path: Path,
                                                                           capsys: pytest.CaptureFixture[str]) -> None:
    path = recorded(tmp_path, ".asc")
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:-50]), encoding="utf-8")
    capsys.readouterr()
    assert run(["rig", "s1", "--replay", str(path), "--json"]) == 1
    failed = [each for each in json.loads(capsys.readouterr().out)["verdicts"] if not each["passed"]]
    assert [each["name"] for each in failed] == ["log"] and "never closed" in failed[0]["detail"]


def test_a_voltage_that_is_missing_in_a_log_is_reported_by_the_counter_of_the_rig(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = recorded(tmp_path, ".asc")
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    voltages = [k for k, line in enumerate(lines) if f" {VOLTAGE:X} " in line]
    del lines[voltages[20]]
    path.write_text("".join(lines), encoding="utf-8")
    capsys.readouterr()
    assert run(["rig", "s1", "--replay", str(path), "--json"]) == 1
    frames = next(each for each in json.loads(capsys.readouterr().out)["verdicts"] if each["name"] == "frames")
    assert not frames["passed"] and frames["detail"] == "1 × VOLTAGE missing"


def test_a_log_is_read_back_frame_by_frame_in_each_format(tmp_path: Path) -> None:
    # each run has a session of its own, so CRC and OPEN differ
    frames = [[(m.arbitration_id, m.arbitration_id != OPEN and bytes(m.data[2:])) for m in read_log(path)]
              for path in (recorded(tmp_path, suffix) for suffix in LOGS)]
    assert len(frames[0]) > 160 and all(each == frames[0] for each in frames)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
@pytest.mark.parametrize("kind", ["asc", "blf"])
@pytest.mark.parametrize("mode", [[], ["--same-bits"], ["--free-run", "--watchdog", "0"]])
def test_a_log_that_takes_no_more_bytes_costs_neither_verdicts_nor_junit(
        kind: str, mode: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, junit = tmp_path / f"full.{kind}", tmp_path / "results.xml"
    log.symlink_to("/dev/full")
    assert run(["rig", "robotino2", *mode, "--steps", "400", "--log", str(log), "--junit", str(junit), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["figures"]["last_step"] >= found["figures"]["steps_wanted"] - ("--free-run" in mode)  # it began at 0
    failed = [each for each in found["verdicts"] if not each["passed"]]
    assert len(found["verdicts"]) > 1 and [each["name"] for each in failed] == ["log"]
    assert f"--log {log}: cannot be written (no space left on device)" in failed[0]["detail"]
    suite = ElementTree.parse(junit).getroot()
    assert suite.get("failures") == "1" and suite.get("tests") == str(len(found["verdicts"]))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
def test_a_junit_file_that_cannot_be_written_leaves_the_verdicts_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "robotino2", "--steps", "5", "--junit", "/dev/full", "--json"]) == 2
    printed = capsys.readouterr()
    assert json.loads(printed.out)["passed"] and "/dev/full: cannot be written" in printed.err.splitlines()[-1]


# ---- The live view on a terminal of 80 columns and 24 lines.

def drawn(view: View) -> list[str]:
    """Its lines on a small terminal."""
    out = io.StringIO()
    console = Console(file=out, width=80, height=24, force_terminal=True, color_system=None)
    console.print(view)
    return out.getvalue().rstrip("\n").split("\n")


def row(lines: list[str], name: str) -> str:
    """The first line of a frame."""
    return next(line for line in lines if name in line)


@pytest.fixture
def view() -> View:
    """A view of a free run of a vehicle with four wheels, in virtual time."""
    with own_node("virtual", "double") as node:
        seen = View(node.link, "kuka_youbot", 300)
        node.link.listeners.append(seen.take)
        judge_free_run(node, read_scene("kuka_youbot"), 0.3, 1000, 100, {}, moved=seen.moved)
    return seen


def test_a_free_run_is_shown_with_counts_and_names_within_80_by_24(view: View) -> None:
    lines = drawn(view)
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert "state free run" in row(lines, "HEARTBEAT") and "command stop" in row(lines, "RESULT")
    assert int(row(lines, "NU ").split("│")[2]) in range(290, 301)
    assert "crc_errors 0" in "\n".join(lines) and "late_periods 0" in "\n".join(lines)


def test_each_group_of_wheels_has_a_line_with_the_wheels_numbers(view: View) -> None:
    lines = [line for line in drawn(view) if "VOLTAGE" in line]
    assert len(lines) == 2 and "voltage_1" in lines[0] and "voltage_4" in lines[1]


def test_more_kinds_of_frames_than_lines_leave_out_the_oldest_and_show_how_many(view: View) -> None:
    for k in range(40):
        view.take(can.Message(arbitration_id=0x700 + k, is_extended_id=False, data=b"\1"))
    for frame in (wire()["NU"], wire()["HEARTBEAT"]):
        view.take(can.Message(arbitration_id=view.link.id_base + frame.offset, is_extended_id=False, data=bytes(8)))
    lines = drawn(view)
    assert len(lines) <= 24 and "more kinds of frames" in lines[-1]
    assert row(lines, "NU ") and "state empty" in row(lines, "HEARTBEAT")
