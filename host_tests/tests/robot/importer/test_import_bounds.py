"""A file that makes a library read for ever, or fill the memory, is ended and named; so is the reading by Ctrl-C."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from laconic.cli.main import run
from laconic.robot.importer import bounded, meshes
from laconic.robot.importer.meshes import MeshFiles
from made_up_robots import MJCF

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
XACRO = f'<robot {NAMESPACE} name="{{}}"/>'
ENDLESS = {"robot.xacro": XACRO.format("${9**9**9}"),
           "robot.xml": MJCF.replace("<worldbody>", '<worldbody><replicate count="100000000" offset="1 0 0">'
                                                    '<geom size="0.1"/></replicate>')}


def imported(folder: Path, name: str, text: str) -> int:
    """The exit status of the import of such a file."""
    (folder / name).write_text(text, encoding="utf-8")
    return run(["import", str(folder / name), "-o", str(folder / "robot.toml")])


@pytest.mark.parametrize(("name", "words"), [
    ("robot.xacro", "xacro does not come to an end within 0.5 s; mend the expression, macro or include"),
    ("robot.xml", "MuJoCo does not come to an end within 0.5 s; mend the count of a <replicate>")])
def test_a_reading_without_end_is_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, words: str,
                                        monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "LONGEST_S", 0.5)
    assert imported(tmp_path, name, ENDLESS[name]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1


@pytest.mark.parametrize("name", ENDLESS)
def test_ctrl_c_ends_a_reading_at_once_and_leaves_nothing_running(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    readers: list[subprocess.Popen[bytes]] = []

    def interrupted(call: tuple[Any, ...], reader: subprocess.Popen[bytes]) -> bytes | None:
        readers.append(reader)
        os.kill(os.getpid(), signal.SIGINT)
        return _answer_to(call, reader)

    _answer_to = bounded._answer_to
    monkeypatch.setattr(bounded, "_answer_to", interrupted)
    assert imported(tmp_path, name, ENDLESS[name]) == 130
    assert capsys.readouterr().err == "laconic: stopped by the user\n"
    assert [each.returncode for each in readers] == [-signal.SIGKILL]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_mesh_that_is_read_without_end_or_fills_the_memory_is_named_and_the_others_are_read(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "wheel.obj").write_text("v 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    (tmp_path / "huge.obj").write_text("", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe.obj")
    (tmp_path / "hung.obj").write_text("mtllib pipe.obj\nusemtl red\nv 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                                       encoding="utf-8")
    with MeshFiles(tmp_path / "robot.urdf") as files:
        first = files.points("wheel.obj")
        assert first is not None and first.shape == (3, 3)
        monkeypatch.setattr(bounded, "LONGEST_S", 0.3)
        assert files.points("hung.obj") is None
        monkeypatch.undo()
        monkeypatch.setattr(meshes, "points_in", filled)
        assert files.points("huge.obj") is None
        monkeypatch.undo()
        assert files.points("pipe.obj") is None
        (tmp_path / "again.obj").write_bytes((tmp_path / "wheel.obj").read_bytes())
        assert files.points("again.obj") is not None
        reader = files.reader._process
    assert files.missing == {"hung.obj": "not read: trimesh does not come to an end within 0.3 s",
                             "huge.obj": "not read: trimesh needs more than 2 GiB of memory",
                             "pipe.obj": "is no regular file"}
    assert reader is not None and reader.returncode == -signal.SIGKILL  # none is left


def filled(path: Path) -> None:
    bytearray(3 * 2**30)


@pytest.mark.parametrize(("name", "text", "words"), [
    ("robot.xacro", XACRO.format("${[0] * 10**10}"), "xacro needs more than 2 GiB of memory; mend the expression"),
    ("robot.xml", MJCF.replace("<worldbody>", '<size memory="900G"/><worldbody>'),
     "MuJoCo needs more than 2 GiB of memory; mend the count"),
    ("robot.xml", MJCF.replace("<worldbody>", '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/>'
                                              "</asset><worldbody>"), "a mesh, texture or hfield, or <size>, that"),
    ("robot.xacro", f'<robot {NAMESPACE}><xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/></robot>',
     "a macro calls, or a file includes, itself without end; mend it")])
def test_what_needs_too_much_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, text: str,
                                      words: str) -> None:
    assert imported(tmp_path, name, text) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1


@pytest.mark.parametrize("path, words", [(Path(os.devnull), "is no regular file; give the file of a robot"),
                                         (Path(), "is a directory; give the file of a robot")])
def test_what_is_no_file_is_not_read(tmp_path: Path, capsys: pytest.CaptureFixture[str], path: Path,
                                     words: str) -> None:
    assert run(["import", str(path), "-o", str(tmp_path / "robot.toml")]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("name", ["robot.urdf", "robot.xml"])
def test_a_file_beyond_all_robots_is_not_read(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(65 * 2**20)  # takes no room on the disk
    assert run(["import", str(tmp_path / name), "-o", str(tmp_path / "robot.toml")]) == 2
    assert "has 65 MiB, more than the 64 that are read; give the file of a robot" in capsys.readouterr().err


def test_an_argument_that_the_xacro_file_does_not_ask_for_is_refused(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "robot.xacro").write_text(f'<robot {NAMESPACE} name="r"><xacro:arg name="track" default="1"/></robot>')
    assert run(["import", str(tmp_path / "robot.xacro"), "-o", str(tmp_path / "robot.toml"), "--set", "trak:=1"]) == 2
    told = capsys.readouterr().err
    assert "--set trak: " in told
    assert "does not ask for an argument of this name; did you mean track?" in told


def waiting_beside(fifo: Path) -> None:
    with fifo.open("w", encoding="utf-8") as there:
        there.write("here")
        there.flush()
        threading.Event().wait()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_reading_whose_asker_is_killed_ends_soon(tmp_path: Path) -> None:
    os.mkfifo(fifo := tmp_path / "fifo")
    asks = ("from pathlib import Path\nfrom laconic.robot.importer import bounded\nimport test_import_bounds as here\n"
            f"bounded.bounded(bounded.Library('it', 'this'), here.waiting_beside, Path({str(fifo)!r}))")
    asker = subprocess.Popen([sys.executable, "-c", asks], env=bounded._environment())
    with fifo.open("rb", buffering=0) as ends:
        assert ends.read(4) == b"here"
        asker.kill()
        asker.wait()
        readable, _, _ = select.select([ends], [], [], 10.0)
        assert readable and ends.read(1) == b""  # the reader's end is closed


def lacking(path: Path) -> None:
    raise ModuleNotFoundError(f"No module named 'mujoco' for {path}", name="mujoco")


def test_a_library_that_is_not_installed_is_told_as_in_the_commands_own_process() -> None:
    with pytest.raises(ModuleNotFoundError) as raised:
        bounded.bounded(bounded.Library("MuJoCo", "this"), lacking, Path("robot.xml"))
    assert raised.value.name == "mujoco"


@pytest.mark.parametrize("text", ["admin:secret-7:0:0", "a: [secret-7", "- !secret-7 x"])
def test_no_message_shows_the_text_of_a_file_that_load_yaml_reads(tmp_path: Path, capsys: pytest.CaptureFixture[str],
                                                                  text: str) -> None:
    (tmp_path / "private").write_text(text, encoding="utf-8")
    link = f"<link name=\"${{xacro.load_yaml('{tmp_path}/private')}}\"/>"
    assert imported(tmp_path, "robot.xacro", f"<robot {NAMESPACE} name='r'>{link}{link}</robot>") == 2
    told = capsys.readouterr().err
    assert "load_yaml: " in told
    assert "secret" not in told


TRIANGLE = "v 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.mark.parametrize("uri", ["../outside.obj", "../../outside.obj", "meshes/../../../outside.obj",
                                 "package://kit/../../outside.obj", "file://{}/outside.obj", "{}/outside.obj"])
def test_a_mesh_outside_of_the_robots_folder_is_not_opened(tmp_path: Path, uri: str,
                                                           monkeypatch: pytest.MonkeyPatch) -> None:
    kit = tmp_path / "some" / "kit"
    (kit / "meshes").mkdir(parents=True)
    for folder in (tmp_path, tmp_path / "some"):
        (folder / "outside.obj").write_text(TRIANGLE, encoding="utf-8")
    monkeypatch.setattr(MeshFiles, "_points_of", lambda *_: pytest.fail("it was opened"))
    with MeshFiles(kit / "robot.urdf") as files:
        assert files.points(uri.format(tmp_path)) is None
    assert list(files.missing.values()) == ["lies outside the robot's folder and is not opened; --package "
                                            "NAME=FOLDER says where it may lie"]


@pytest.mark.parametrize("robot, uri", [
    ("robots/a/b/robot.urdf", "../../../meshes/wheel.obj"), ("urdf/robot.urdf", "package://kit/meshes/wheel.obj"),
    ("urdf/robot.urdf", "package://given/wheel.obj"), ("urdf/robot.urdf", "file://{}/../elsewhere/wheel.obj"),
    *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("robot.urdf", "meshes/wheel.obj"), ("urdf/robot.urdf", "../meshes/wheel.obj"),
        ("urdf/robot.urdf", "file://{}/meshes/wheel.obj"), ("urdf/robot.urdf", "package://other/wheel.obj")))])
def test_a_mesh_of_the_robot_its_kit_or_a_package_is_read(tmp_path: Path, robot: str, uri: str,
                                                          monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded.Reader, "ask", lambda _, call, path: call(path))  # without a process of its own
    kit = tmp_path / "kit"
    for folder in (kit / "meshes", tmp_path / "other", tmp_path / "elsewhere", (kit / robot).parent):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "wheel.obj").write_text(TRIANGLE, encoding="utf-8")
    for package in (kit, tmp_path / "other"):
        (package / "package.xml").touch()
    with MeshFiles(kit / robot, {"given": tmp_path / "elsewhere"}) as files:
        found = files.points(uri.format(kit))
    assert found is not None and found.shape == (3, 3) and not files.missing


def test_a_mesh_behind_a_link_that_leaves_the_robots_folder_is_not_opened(tmp_path: Path) -> None:
    (tmp_path / "kit").mkdir()
    (tmp_path / "wheel.obj").write_text(TRIANGLE, encoding="utf-8")
    (tmp_path / "kit" / "linked.obj").symlink_to(tmp_path / "wheel.obj")
    with MeshFiles(tmp_path / "kit" / "robot.urdf") as files:
        assert files.points("linked.obj") is None
    assert "lies outside the robot's folder" in files.missing["linked.obj"]


def chain(form: str, count: int) -> str:
    if form == "robot.xml":
        body = "<body><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body>"
        return f"<mujoco><worldbody>{body * count}</worldbody></mujoco>"
    links = "".join(f'<link name="l{k}"/>' for k in range(count))
    if form == "robot.urdf":
        joints = "".join(f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
                         for k in range(count - 1))
        return f'<robot name="chain">{links}{joints}</robot>'
    return f'<sdf version="1.8"><model name="chain">{links}</model></sdf>'


@pytest.mark.parametrize("form", ["robot.urdf", "robot.sdf", "robot.xml"])
def test_a_chain_of_more_links_than_any_robot_has_is_refused_at_once(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], form: str) -> None:
    assert imported(tmp_path, form, chain(form, 10_001)) == 2
    told = capsys.readouterr().err
    assert f"{form}: has 1000" in told and " links, more than the 5000 that are read" in told
