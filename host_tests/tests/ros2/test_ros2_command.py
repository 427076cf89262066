"""The command `laconic ros2`: its lines, its exit status, and what it needs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import laconic
from laconic.base.extras import extra_of
from laconic.cli.main import run
from laconic.ros2.session import Session

LOCAL = ["--local", "--domain", "79"]


def test_a_run_ends_after_its_duration_with_figures(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.2", "--json"]) == 0
    printed = capsys.readouterr()
    figures = json.loads(printed.out)
    assert figures["cycles"] == 10 and figures["messages"] == 50 and figures["commands"] == 0
    assert figures["final"] == {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0}
    assert "hears Twist or TwistStamped on /cmd_vel" in printed.err


def test_a_car_says_what_drives_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "f1tenth", *LOCAL, "--duration", "0.1"]) == 0
    assert "hears Twist or TwistStamped on /cmd_vel and AckermannDriveStamped on ackermann_cmd and drive" in \
        capsys.readouterr().out


def test_a_record_is_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.toml"
    assert run(["ros2", "turtlebot3_burger", *LOCAL, "--duration", "0.1", "--record", str(path)]) == 0
    assert f"wrote {path}: 100 steps" in capsys.readouterr().out
    scene = laconic.read_scene(path)
    assert scene.run.duration_s == pytest.approx(0.1) and scene.inputs == ()  # nothing moved, so no voltage acted


def test_the_environment_names_domain_and_distribution(monkeypatch: pytest.MonkeyPatch,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "80")
    monkeypatch.setenv("ROS_DISTRO", "humble")
    assert run(["ros2", "robotino2", "--local", "--duration", "0.1"]) == 0
    assert "in domain 80," in capsys.readouterr().out
    monkeypatch.setenv("ROS_DOMAIN_ID", "home")
    assert run(["ros2", "robotino2", "--local"]) == 2
    assert "ROS_DOMAIN_ID: home is not a whole number" in capsys.readouterr().err


@pytest.mark.parametrize("words, of_environment, cyclone, fast", [
    ([], "", True, True), (["--rmw", "fastrtps"], "", False, True), ([], "rmw_fastrtps_cpp", False, True),
    ([], "rmw_other", True, True), (["--rmw", "cyclonedds"], "rmw_fastrtps_cpp", True, False)])
def test_services_are_those_of_the_middleware(words: list[str], of_environment: str, cyclone: bool, fast: bool,
                                              monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RMW_IMPLEMENTATION", of_environment)
    made: list[Session] = []
    monkeypatch.setattr(Session, "run", lambda session: made.append(session))
    assert run(["ros2", "robotino2", *LOCAL, *words]) == 0
    node = made[0].robots[0].node
    assert (bool(node.services[0].reader), bool(node.other_readers)) == (cyclone, fast)


def test_without_its_package_the_extra_is_named() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            "sys.exit(run(['ros2', 'robotino2']))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("laconic: ") and done.stderr.count("\n") == 1 and "cyclonedds" in done.stderr
    assert extra_of("cyclonedds") == "ros2"


def test_its_help_needs_no_package() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            "sys.exit(run(['ros2', '--help']))")
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_a_signal_ends_the_run_in_order(number: int) -> None:
    words = [sys.executable, "-m", "laconic", "ros2", "robotino2", *LOCAL, "--json"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        assert "Festo Robotino 2" in process.stderr.readline()  # it runs
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 0
    assert "stopped by the user" in err and json.loads(out)["robots"] == 1
