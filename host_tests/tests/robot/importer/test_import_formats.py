"""MJCF and SDF become the scene that the same robot has as URDF.

Broken files: each gives a scene with wheels, or one line; none a traceback or the words of one.

The campaign is host_tests/assurance/imports.py; these are its first files.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

from assurance.imports import ROBOTS, broken, campaign
from laconic.errors import BadInput
from laconic.robot.importer import Answers, import_robot
from laconic.scene.table import read_toml
from made_up_robots import MJCF, SDF, TWO_WHEELS, joint, link, robot


def vehicle(tmp_path: Path, name: str, text: str, answers: Answers | None = None) -> dict[str, Any]:
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "scene.toml").write_text(import_robot(tmp_path / name, answers or Answers()).text, encoding="utf-8")
    found: dict[str, Any] = read_toml(tmp_path / "scene.toml").plain()["vehicle"]
    return found


@pytest.mark.parametrize(("name", "text"), [("robot.xml", MJCF), ("robot.sdf", SDF)])
def test_the_same_robot_gives_the_same_vehicle(tmp_path: Path, name: str, text: str) -> None:
    expected = vehicle(tmp_path, "robot.urdf", robot(TWO_WHEELS))
    found = vehicle(tmp_path, name, text)
    wheels = found.pop("wheel"), expected.pop("wheel")
    assert found == pytest.approx(expected, abs=1e-9)
    for one, other in zip(*wheels, strict=True):
        assert one.pop("kind") == other.pop("kind")
        assert one == pytest.approx(other, abs=1e-6)


def test_one_of_several_models_is_taken_by_name(tmp_path: Path) -> None:
    two = SDF.replace("</model>", "</model><model name='other'><link name='lone'/></model>", 1)
    with pytest.raises(BadInput, match=r"has 2 models with links \(made_up, other\); name one with --model"):
        vehicle(tmp_path, "two.sdf", two)
    assert len(vehicle(tmp_path, "two.sdf", two, Answers(model="made_up"))["wheel"]) == 2


def test_poses_that_form_a_loop_are_one_line(tmp_path: Path) -> None:
    loop = SDF.replace('<frame name="mast"><pose>', '<frame name="mast"><pose relative_to="base">')
    with pytest.raises(BadInput, match=r"the pose of (mast|base) is relative to itself"):
        vehicle(tmp_path, "loop.sdf", loop)


CHAIN = 2000


def test_long_chains_are_read_link_by_link(tmp_path: Path) -> None:
    fixed = "".join(link(f"l{k + 1}") + joint(f"j{k}", "fixed", f"l{k}" if k else "base", f"l{k + 1}")
                    for k in range(CHAIN))
    end = TWO_WHEELS.replace('<parent link="base"/>', f'<parent link="l{CHAIN}"/>')
    began = time.process_time()
    assert vehicle(tmp_path, "chain.urdf", robot(end, fixed))["wheel"]
    assert time.process_time() - began < 10.0  # comparing each link with all others took minutes
    frames = "".join(f'<frame name="f{k}"><pose relative_to="{f"f{k - 1}" if k else "mast"}"/></frame>'
                     for k in range(CHAIN))
    last = SDF.replace('relative_to="mast"/>', f'relative_to="f{CHAIN - 1}"/>')
    chained = vehicle(tmp_path, "chain.sdf", last.replace("</model>", frames + "</model>"))
    assert chained == vehicle(tmp_path, "robot.sdf", SDF)


def test_a_wheel_that_mimics_another_is_told_to_turn_on_its_own(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(robot(TWO_WHEELS).replace("</joint>", '<mimic joint="right"/></joint>', 1))
    remarks = import_robot(tmp_path / "robot.urdf", Answers()).remarks
    assert "joint left mimics right, which is not taken over: each wheel turns on its own" in remarks


@pytest.mark.parametrize("encoding", ["ISO-8859-1", "UTF-16", "windows-1252"])
@pytest.mark.parametrize(("name", "text"), [("robot.urdf", robot(TWO_WHEELS, name="Räd")),
                                            ("robot.sdf", SDF.replace("made_up", "Räd"))])
def test_a_file_is_read_in_the_encoding_that_its_first_line_names(tmp_path: Path, name: str, text: str,
                                                                  encoding: str) -> None:
    (tmp_path / name).write_bytes(f'<?xml version="1.0" encoding="{encoding}"?>{text}'.encode(encoding))
    assert import_robot(tmp_path / name, Answers()).name == "Räd"


def test_an_encoding_that_no_line_names_or_none_knows_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    text = robot(TWO_WHEELS, name="Räd")
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(BadInput, match="its first line names no other encoding; save it as UTF-8, or begin it with <"):
        import_robot(path, Answers())
    path.write_bytes(f'<?xml version="1.0" encoding="klingon"?>{text}'.encode("latin-1"))
    with pytest.raises(BadInput, match="is no URDF that can be read: unknown encoding"):
        import_robot(path, Answers())


FILES, AT_ONCE = 200, 20


@pytest.mark.parametrize("first", [
    0, *(pytest.param(each, marks=pytest.mark.nightly) for each in range(AT_ONCE, FILES, AT_ONCE))])
def test_a_broken_file_is_a_scene_or_one_line(tmp_path: Path, first: int) -> None:
    faults: list[str] = []
    ends = campaign(range(first, first + AT_ONCE), ROBOTS, tmp_path, faults.append)
    assert faults == []
    assert set(ends) == {"scene", "refused"}


def test_the_files_are_broken_and_all_kinds_of_robots_are_among_them() -> None:
    whole = {text for _, text in ROBOTS}
    files = [broken(seed) for seed in range(FILES)]
    assert sum(text in whole for _, text in files) < FILES // 20
    assert {name for name, _ in files} == {name for name, _ in ROBOTS}
    assert files == [broken(seed) for seed in range(FILES)]
