"""Runs for Foxglove and Rerun: the robot where the run has it, wheels that roll, plots that find their signals."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

import laconic
from laconic.cli.main import run
from laconic.pictures.views.robot_view import RobotView, needed_signals, of_wheel, panels_of

Json = dict[str, Any]


def messages(path: Path) -> dict[str, list[Json]]:
    """Those of each topic."""
    found: dict[str, list[Json]] = {}
    with path.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            found.setdefault(channel.topic, []).append(json.loads(message.data))
    return found


def written(scene: str, folder: Path) -> tuple[dict[str, list[Json]], Json]:
    """Messages and layout of a run."""
    assert run(["simulate", scene, "--foxglove", str(folder / "run.mcap")]) == 0
    return messages(folder / "run.mcap"), json.loads((folder / "run.layout.json").read_text())


def test_foxglove_gets_its_own_schemas_by_name(tmp_path):
    assert run(["simulate", "turtlebot3_burger", "--foxglove", str(tmp_path / "run.mcap")]) == 0
    with (tmp_path / "run.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    kinds = {each.topic: summary.schemas[each.schema_id].name for each in summary.channels.values()}
    assert kinds == {"/tf": "foxglove.FrameTransforms", "/robot": "foxglove.SceneUpdate",
                     "/path": "foxglove.SceneUpdate", "/pose": "foxglove.PoseInFrame", "/signals": "laconic.Signals"}
    assert {each.message_encoding for each in summary.channels.values()} == {"json"}


@pytest.mark.parametrize("scene", ["turtlebot3_burger", "tugger_train"])
def test_every_part_is_drawn_in_a_frame_that_moves(scene, tmp_path):
    found, _ = written(scene, tmp_path)
    frames = {each["child_frame_id"]: each["parent_frame_id"] for each in found["/tf"][0]["transforms"]}
    drawn = {each["frame_id"] for each in found["/robot"][0]["entities"]}
    assert drawn == set(frames) and set(frames.values()) <= {*frames, "map"}
    assert len(found["/tf"]) == len(found["/signals"])


def test_trailers_are_where_the_run_has_them(tmp_path):
    found, _ = written("tugger_train", tmp_path)
    scene = laconic.read_scene("tugger_train")
    columns = laconic.simulate(scene, needed_signals(scene)).columns
    last = {each["child_frame_id"]: each for each in found["/tf"][-1]["transforms"]}
    for hinge in scene.hinges:
        place, turn = (last[hinge.name][name] for name in ("translation", "rotation"))
        assert place["x"] == columns[f"body_x_m[{hinge.name}]"][-1]
        assert place["y"] == columns[f"body_y_m[{hinge.name}]"][-1]
        assert 2.0 * math.atan2(turn["z"], turn["w"]) == pytest.approx(columns[f"body_heading_rad[{hinge.name}]"][-1])


def test_a_wheel_that_turns_ahead_moves_its_top_ahead():
    """A wheel with axle_deg = -90 rolls ahead by positive angles; its own frame has the axle first."""
    x, y, z, w = of_wheel(-0.5 * math.pi, 0.01)
    u, top = np.array([x, y, z]), np.array([0.0, 0.0, 1.0])
    moved = top + 2.0 * np.cross(u, np.cross(u, top) + w * top)
    assert moved == pytest.approx([math.sin(0.01), 0.0, math.cos(0.01)])


def test_wheels_without_angles_turn_by_their_speeds():
    view = RobotView(laconic.read_scene("turtlebot3_burger"))
    signals = {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0, "wheel_speed_rad_per_s[1]": 2.0}
    view.frames(0.0, signals)
    wheel = view.frames(0.25, signals)[1]
    assert wheel.turn == pytest.approx(of_wheel(-0.5 * math.pi, 0.5))


@pytest.mark.parametrize("scene", ["kuka_youbot", "frc_swerve_mk4i"])
def test_each_curve_of_the_layout_is_in_the_messages(scene, tmp_path):
    found, layout = written(scene, tmp_path)
    paths = [path["value"] for name, panel in layout["configById"].items() if name.startswith("Plot!")
             for path in panel["paths"]]
    assert len(paths) > 8
    for path in paths:
        topic, *parts = path.replace("[", ".").replace("]", "").split(".")
        value: Any = found[topic][3]
        for part in parts:
            value = value[int(part)] if isinstance(value, list) else value[part.strip('"')]
        assert isinstance(value, float)


def test_all_panels_of_the_layout_are_on_the_screen(tmp_path):
    _, layout = written("tugger_train", tmp_path)

    def leaves(node: Any) -> list[str]:
        return [node] if isinstance(node, str) else [*leaves(node["first"]), *leaves(node["second"])]

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])


def test_a_file_for_foxglove_that_was_cut_off_is_readable(tmp_path):
    """The process dies without a chance to close its files."""
    path = tmp_path / "run.mcap"
    code = (
        "import os, laconic\nfrom pathlib import Path\n"
        "from laconic.pictures.views.foxglove import open_foxglove\n"
        "from laconic.pictures.views.robot_view import needed_signals\n"
        "scene = laconic.read_scene('turtlebot3_burger')\nrun = laconic.simulate(scene, needed_signals(scene))\n"
        f"with open_foxglove(Path({str(path)!r}), scene) as viewer:\n    for k, time_s in enumerate(run.time_s):\n"
        "        viewer.take(time_s, {name: float(each[k]) for name, each in run.columns.items()})\n    os._exit(9)\n")
    assert subprocess.run([sys.executable, "-c", code], env=os.environ, check=False).returncode == 9
    with path.open("rb") as file:
        from laconic.robot.bags.containers import opened

        assert file.read(8) == b"\x89MCAP0\r\n"
    recording = opened(path)
    try:
        assert len(list(recording.messages({"/tf"}))) > 500
    finally:
        recording.close()
    assert (tmp_path / "run.layout.json").exists()


@pytest.mark.parametrize(("arguments", "words"), [
    (["--rerun", "run.mcap"], "choose a name that ends in .rrd"),
    (["--storage", "mcap"], "give --bag FOLDER"),
    (["--bag", "run.mcap", "--storage", "mcap"], "give --bag FOLDER"),
    (["--bag", "run.mcap", "--foxglove", "run.mcap"], "give each a file of its own")])
def test_options_that_do_not_go_together_are_refused(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["simulate", "turtlebot3_burger", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_without_the_package_rerun_says_how_to_install_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "rerun", None)
    monkeypatch.setattr("importlib.metadata.requires", lambda _: ["rerun-sdk>=0.24 ; extra == 'rerun'"])
    assert run(["simulate", "turtlebot3_burger", "--rerun", str(tmp_path / "run.rrd")]) == 2
    assert 'rerun-sdk, which is not installed; pip install "laconic[rerun]"' in capsys.readouterr().err


def test_a_rig_and_a_played_vehicle_are_shown(tmp_path):
    rig, play = tmp_path / "rig.mcap", tmp_path / "play.mcap"
    assert run(["rig", "turtlebot3_burger", "--free-run", "--steps", "100", "--foxglove", str(rig)]) == 0
    assert len(messages(rig)["/tf"]) > 90
    options = ["--listen", "0", "--drives", "odrive", "--duration", "0.2"]
    assert run(["play", "robotino2", *options, "--foxglove", str(play)]) == 0
    assert {"/tf", "/robot", "/signals", "/pose"} <= set(messages(play))


def test_what_is_plotted_depends_on_the_vehicle():
    burger, tugger = (laconic.read_scene(name) for name in ("turtlebot3_burger", "tugger_train"))
    assert [each.title for each in panels_of(burger, needed_signals(burger))][:3] == [
        "velocity [m/s], yaw rate [rad/s]", "wheel speeds [rad/s]", "inputs"]
    assert "hinge angles [rad]" in [each.title for each in panels_of(tugger, needed_signals(tugger))]


@pytest.mark.nightly
def test_rerun_has_robot_path_plots_and_blueprint(tmp_path):
    """The library's own program lists the chunks of a file."""
    pytest.importorskip("rerun")
    path = tmp_path / "run.rrd"
    assert run(["simulate", "tugger_train", "--rerun", str(path)]) == 0
    listed = subprocess.run([sys.executable, "-m", "rerun", "rrd", "print", str(path)], capture_output=True, text=True,
                            check=True).stdout
    for part in ("/world/robot/base_link/shape - ", "/world/robot/third/wheel_", "/world/path/",
                 "/signals/yaw_rate_rad_per_s - ", "ViewBlueprint:class_identifier", "EyeControls3D:look_target"):
        assert part in listed
