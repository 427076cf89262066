"""What the command line of laconic rig refuses: options that would be ignored, and those without meaning."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from laconic.can.rig.bus_options import known_options, read_bus_options
from laconic.can.rig.faults import faults_from
from laconic.cli.main import run


@pytest.mark.parametrize("arguments, words", [
    (["--interface", "faulty", "--bus-option", "los=0.1"], "did you mean loss?"),
    (["--interface", "slcan", "--channel", "x", "--bus-option", "loss=0.1"], "--interface faulty"),
    (["--interface", "virtual", "--channel", "x", "--bus-option", "nosuch=1"], "no such option"),
    (["--interface", "faulty", "--bus-option", "under=slcan", "--bus-option", "tty_baud=1"], "tty_baudrate"),
    (["--interface", "socketcan", "--channel", "x", "--bus-option", "bitrate=5"], "--bitrate"),
    (["--interface", "faulty", "--bus-option", "loss=0.1", "--bus-option", "loss=0.2"], "twice"),
    (["--interface", "faulty", "--bus-option", "loss=2"], "from 0 to 1"),
    (["--interface", "faulty", "--bus-option", "delay_s=-1"], "zero or more"),
    (["--interface", "faulty", "--bus-option", "delay_s=nan"], "zero or more"),
    (["--interface", "faulty", "--bus-option", "keep_queue=perhaps"], "true or false")])
def test_a_bus_option_that_nobody_would_read_is_refused_with_the_nearest_name(
        arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", "--steps", "5", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "--bus-option" in error and words in error


def test_options_that_an_interface_only_looks_up_in_its_keyword_arguments_are_known() -> None:
    assert {"tseg1", "accept_virtual", "fd"} <= known_options("kvaser")
    assert {"btr", "listen_only"} <= known_options("slcan")


def test_a_truth_and_a_number_reach_the_interface_as_such_and_an_identifier_may_be_hexadecimal() -> None:
    assert read_bus_options(["listen_only=false", "timeout=0.5"], "slcan") == {"listen_only": False, "timeout": 0.5}
    assert faults_from(read_bus_options(["only_id=0x203"], "faulty")).only_id == 0x203


@pytest.mark.parametrize("option", [["--board", "process"], ["--interface", "slcan"], ["--steps", "5"], ["--live"],
                                    ["--log", "again.blf"], ["--bus-option", "loss=0.1"]])
def test_a_replay_refuses_what_has_a_meaning_for_a_node_alone(option: list[str], tmp_path: Path,
                                                               capsys: pytest.CaptureFixture[str],
                                                               monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["rig", "s1", "--replay", "run.blf", *option]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"laconic: {option[0]}: ") and "--replay" in error and error.count("\n") == 1


@pytest.mark.parametrize("given, shown", [("0x210", "0x210"), ("700", "0x2BC"), ("-32", "-0x20"), ("0x800", "0x800")])
def test_a_wrong_id_base_is_echoed_as_identifiers_are_written(given: str, shown: str,
                                                              capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", "--id-base", given]) == 2
    assert f"--id-base {given}: {shown} cannot" in capsys.readouterr().err


def test_a_wrong_id_base_of_the_scene_is_echoed_so_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from laconic.base.paths import SCENE_DIR
    path = tmp_path / "scene.toml"
    path.write_text((SCENE_DIR / "s1.toml").read_text(encoding="utf-8") + "\n[rig]\nid_base = 700\n", encoding="utf-8")
    assert run(["rig", str(path)]) == 2
    error = capsys.readouterr().err
    assert "rig.id_base: 0x2BC cannot" in error and str(path) in error


def test_a_missing_scene_is_refused_where_one_is_needed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig"]) == 2
    assert "SCENE" in capsys.readouterr().err
    assert run(["rig", "--stop"]) == 2
    assert "--interface" in capsys.readouterr().err
    assert run(["rig", "--stop", "--interface", "slcan", "--channel", "socket://127.0.0.1:1", "--free-run"]) == 2
    assert "--free-run: has no meaning beside --stop" in capsys.readouterr().err


@pytest.mark.parametrize("arguments, words", [
    (["--free-run", "--watchdog", "10"], "every 10 ms"),
    (["--bitrate", "500000"], "--bitrate 500000: give its --interface"),
    (["--bitrate", "-5"], "--bitrate -5: must be above 0"),
    (["--interface", "slcan", "--channel", "socket://127.0.0.1:1", "--bitrate", "0"], "must be above 0"),
    (["--interface", "slcan", "--channel", "socket://127.0.0.1:99999"], "from 1 to 65535"),
    (["--interface", "slcan", "--channel", "socket://127.0.0.1"], "names no port")])
def test_numbers_that_cannot_work_are_refused_before_anything_is_sent(arguments: list[str], words: str,
                                                                     capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and words in error


def test_a_free_run_reports_its_results_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", "--free-run", "--steps", "50", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["passed"] is True and {"rig", "timeouts"} <= {each["name"] for each in result["verdicts"]}
