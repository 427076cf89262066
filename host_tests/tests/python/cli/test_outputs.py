"""What commands write: never over an input, never twice to one file, whole or not at all; folders are made."""

from __future__ import annotations

import json
import os
import stat
from pathlib import Path

import click
import pytest

from laconic.base import outputs
from laconic.base.paths import scene_names, scene_path
from laconic.cli import options
from laconic.cli.main import commands, run
from laconic.errors import BadInput

SCENE = "paper_caster"


@pytest.fixture
def scene(tmp_path, monkeypatch) -> Path:
    """A scene of the user's own in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "own.toml"
    path.write_text(scene_path(SCENE).read_text())
    return path


def refused(capsys, *arguments: object) -> str:
    """The one line of a command line that is refused."""
    assert run([str(each) for each in arguments]) == 2, arguments
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("laconic: ") and printed.err.count("\n") == 1
    return printed.err


def parameters() -> list[tuple[str, click.Parameter]]:
    """Every argument and option of every command."""
    found = []
    for name in commands.list_commands(None):
        found += [(name, each) for each in commands.get_command(None, name).params]
    return found


def test_no_option_names_a_file_without_the_rule():
    for name, each in parameters():
        assert not isinstance(each.type, (click.Path, click.File)), f"{name} {each.opts}: take a type of options.py"
        if each.name in ("scene", "scenes", "scene_name"):
            assert isinstance(each.type, options.SceneName), f"{name} {each.opts}"
        if "--out" in each.opts:
            assert isinstance(each.type, (options.OutputFile, options.OutputFolder)), name
        if "--json" in each.opts and name != "derive":  # derive writes its JSON to --out
            assert each.callback is not None, f"{name}: take json_flag"


INPUT_OVER = [
    ("simulate", "own.toml", "--out", "own.toml"),
    ("simulate", "--out", "own.toml", "own.toml"),
    ("simulate", "own.toml", "--plot", "own.toml"),
    ("derive", "own.toml", "-o", "own.toml"),
    ("fmu", "own.toml", "--fmi", "2", "-o", "own.toml"),
    ("rig", "own.toml", "--log", "own.toml"),
    ("rig", "own.toml", "--junit", "own.toml"),
    ("analyse", "own.toml", "--out", "own.toml"),
    ("report", "--scene", "own.toml", "--out", "own.toml"),
    ("demo", "own.toml", "--out", "own.toml"),
    ("trim", "own.toml", "--out", "own.toml"),
    ("replay", "own.toml", "own.toml", "--out", "own.toml"),
]


@pytest.mark.parametrize("arguments", INPUT_OVER, ids=" ".join)
def test_no_command_writes_over_its_input(scene, capsys, arguments):
    before = scene.read_bytes()
    refused(capsys, *arguments)
    assert scene.read_bytes() == before


@pytest.mark.parametrize("link", [os.link, os.symlink])
@pytest.mark.parametrize("command", [("simulate", "--out", ".csv"), ("simulate", "--plot", ".png"),
                                     ("derive", "-o", ".txt"), ("fmu", "-o", ".fmu"), ("rig", "--log", ".blf"),
                                     ("rig", "--junit", ".xml")], ids=" ".join)
def test_a_link_is_the_file_that_it_leads_to(scene, capsys, link, command):
    name, option, ending = command
    alias = scene.with_name("alias" + ending)
    link(scene, alias)
    more = ["--fmi", "3"] if name == "fmu" else []
    before = scene.read_bytes()
    assert "is a file that this command reads" in refused(capsys, name, scene, option, alias, *more)
    assert "is a file that this command reads" in refused(capsys, name, option, alias, *more, alias)
    assert scene.read_bytes() == before


def test_what_a_scene_is_replayed_from_is_an_input_too(scene, capsys):
    log = scene.with_name("run.blf")
    log.write_bytes(b"")
    assert "reads" in refused(capsys, "rig", SCENE, "--replay", log, "--log", log)


@pytest.mark.parametrize("arguments", [
    ("simulate", SCENE, "--out", "same.csv", "--plot", "./same.csv"),
    ("rig", SCENE, "--log", "same.blf", "--log", "new/../same.blf"),
    ("demo", SCENE, "own.toml", SCENE)], ids=" ".join)
def test_no_command_writes_twice_to_one_file(scene, capsys, arguments):
    refused(capsys, *arguments)
    assert sorted(path.name for path in scene.parent.iterdir()) == ["own.toml"]


def test_two_names_of_one_output_are_one_file(scene, capsys, monkeypatch):
    monkeypatch.setattr(options.OutputFile, "endings", (), raising=False)
    there = scene.with_name("a.png")
    there.write_bytes(b"before")
    os.link(there, scene.with_name("b.csv"))
    assert "is where --out writes, too" in refused(capsys, "simulate", SCENE, "--out", "b.csv", "--plot", "a.png")
    assert there.read_bytes() == b"before"


@pytest.mark.parametrize("arguments", [("--out", "-", "--json"), ("--json", "--out", "/dev/stdout")], ids=" ".join)
def test_stdout_holds_one_document(capsys, arguments):
    assert "too" in refused(capsys, "simulate", SCENE, *arguments)


@pytest.mark.parametrize("arguments", [
    ("simulate", SCENE, "--plot", "-"), ("fmu", SCENE, "--fmi", "2", "-o", "-"), ("rig", SCENE, "--log", "-")])
def test_only_text_goes_to_stdout(scene, capsys, arguments):
    assert "stdout" in refused(capsys, *arguments)


@pytest.mark.parametrize("arguments", [
    ("simulate", SCENE, "--out", "x.txt"), ("simulate", SCENE, "--out", "x"), ("simulate", SCENE, "--plot", "x.jpeg"),
    ("derive", SCENE, "-o", "x.tex"), ("derive", SCENE, "--latex", "-o", "x.txt"), ("derive", SCENE, "-o", "x.pdf"),
    ("derive", SCENE, "--c", "--json", "-o", "x.c"),
    ("fmu", SCENE, "--fmi", "2", "-o", "x.txt"), ("fmu", SCENE, "--fmi", "2", "-o", "x.ssp"),
    ("fmu", SCENE, "--fmi", "2", "--ssp", "-o", "x.fmu"),
    ("rig", SCENE, "--log", "x.txt"), ("rig", SCENE, "--junit", "x.json")], ids=" ".join)
def test_a_name_ends_as_its_format(scene, capsys, arguments):
    assert "choose a name that ends in ." in refused(capsys, *arguments)
    assert sorted(path.name for path in scene.parent.iterdir()) == ["own.toml"]


@pytest.mark.parametrize("arguments", [
    ("simulate", SCENE, "--out", "a/b/run.csv"), ("simulate", SCENE, "--plot", "a/b/run.PNG"),
    ("derive", SCENE, "-o", "a/b/run.txt"),
    pytest.param(("derive", SCENE, "--json", "-o", "a/b/run.json"), marks=pytest.mark.nightly),
    ("fmu", SCENE, "--fmi", "2", "-o", "a/b/run.fmu"),
    ("fmu", SCENE, "--fmi", "2", "--ssp", "-o", "a/b/run.ssp"),
    ("rig", "s1", "--steps", "2", "--log", "a/b/run.blf"), ("rig", "s1", "--steps", "2", "--junit", "a/b/run.xml"),
    ("trim", SCENE, "--out", "a/b"), ("rig", SCENE, "--a2l", "a/b/run.a2l"),
    ("play", "canopen_agv", "--eds", "a/b/run.eds")], ids=" ".join)
def test_folders_of_an_output_are_made_and_told(scene, capsys, arguments):
    assert run(list(arguments)) == 0
    assert capsys.readouterr().err.count("laconic: made the folder a/b\n") == 1
    made = list(scene.with_name("a").joinpath("b").iterdir())
    assert made and all(path.stat().st_size > 0 for path in made)
    assert not [path for path in made if path.name.startswith(".")]


@pytest.mark.parametrize("arguments", [("rig", SCENE, "--a2l", "run.a2l"), ("play", "canopen_agv", "--eds", "run.eds")],
                         ids=" ".join)
def test_a_command_that_writes_one_file_says_so(scene, capsys, arguments):
    assert run(list(arguments)) == 0
    assert capsys.readouterr().out == f"wrote {arguments[-1]}\n"


@pytest.mark.parametrize("command", ["demo", "analyse", "trim", "report", "replay"])
@pytest.mark.parametrize("place", ["own.toml", "own.toml/inside", "/dev/null"])
def test_a_folder_does_not_go_where_a_file_is(scene, capsys, command, place):
    named = ["--scene", SCENE] if command == "report" else ["run.csv", SCENE] if command == "replay" else [SCENE]
    assert "cannot be written" in refused(capsys, command, *named, "--out", place)


def test_a_file_does_not_go_where_a_folder_is(scene, capsys):
    scene.with_name("run.csv").mkdir()
    assert "there is a folder of that name" in refused(capsys, "simulate", SCENE, "--out", "run.csv")


def write_half(path: Path, stop: type[BaseException]) -> None:
    with outputs.opened(path) as file:
        file.write("half of ")
        file.flush()
        raise stop


def test_an_output_that_fails_or_is_interrupted_leaves_the_old_file(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("before")
    for stop in (KeyboardInterrupt, ValueError):
        with pytest.raises(stop):
            write_half(path, stop)
        assert path.read_text() == "before"
        assert [each.name for each in tmp_path.iterdir()] == ["run.csv"]


def test_a_plot_that_fails_leaves_the_old_picture(scene, monkeypatch):
    from matplotlib.figure import Figure

    def half(figure, target, **more):
        Path(target).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Figure, "savefig", half)
    picture = scene.with_name("run.png")
    picture.write_bytes(b"before")
    assert run(["simulate", SCENE, "--plot", str(picture)]) == 2
    assert picture.read_bytes() == b"before"
    assert sorted(each.name for each in scene.parent.iterdir()) == ["own.toml", "run.png"]


def test_an_output_keeps_permissions_and_link(tmp_path):
    path, alias = tmp_path / "run.txt", tmp_path / "alias.txt"
    path.write_text("before")
    path.chmod(0o640)
    alias.symlink_to(path)
    outputs.write_text(alias, "after")
    assert path.read_text() == "after" and alias.is_symlink()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    fresh, plain = tmp_path / "fresh.txt", tmp_path / "plain.txt"
    outputs.write_text(fresh, "new")
    plain.write_text("new")
    assert fresh.stat().st_mode == plain.stat().st_mode


def test_devices_take_any_number_of_outputs_of_any_name(capsys):
    assert run(["simulate", SCENE, "--out", os.devnull, "--plot", os.devnull, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["files"] == [os.devnull] * 2
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("arguments", [
    ("simulate", SCENE, "--out"), ("simulate", SCENE, "--plot"), ("derive", SCENE, "-o"),
    ("fmu", SCENE, "--fmi", "2", "-o"), ("rig", "s1", "--steps", "2", "--junit")], ids=" ".join)
def test_a_full_device_is_one_line(capsys, arguments):
    assert run([*arguments, "/dev/full"]) == 2
    printed = capsys.readouterr().err
    assert "/dev/full: cannot be written (no space left on device)" in printed and printed.count("\n") == 1


def test_a_file_is_written_once_in_a_run_and_never_over_an_input(tmp_path):
    with click.Context(click.Command("any")) as context:
        outputs.write_text(tmp_path / "a.txt", "one")
        with pytest.raises(BadInput, match="written twice"):
            outputs.write_text(tmp_path / "new" / ".." / "a.txt", "two")
        outputs.claims(context).read(tmp_path / "b.txt")
        with pytest.raises(BadInput, match="reads"):
            outputs.write_text(tmp_path / "b.txt", "two")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


# ---- laconic scenes


def test_scenes_lists_each_scene_with_its_title(capsys):
    assert run(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == scene_names() and "Tricycle AGV" in "\n".join(lines)
    assert run(["scenes", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)["scenes"]
    assert {"scene": "s1", "name": "S1: three omni wheels, square wave"} in shown


def test_scenes_copies_a_scene_that_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["scenes", "paper_caster", "-o", "my.toml"]) == 0
    assert capsys.readouterr().out == "wrote my.toml\n"
    assert Path("my.toml").read_text() == scene_path("paper_caster").read_text()
    assert run(["scenes", "paper_caster"]) == 0
    assert capsys.readouterr().out == Path("my.toml").read_text()
    assert run(["simulate", "my.toml"]) == 0


def test_scenes_never_overwrites_a_copy_with_changes(scene, capsys):
    told = refused(capsys, "scenes", SCENE, "-o", "own.toml")
    assert "exists already and may hold your changes" in told


@pytest.mark.parametrize("arguments, message", [
    (["robotino3"], "did you mean robotino2?"), (["../scenes/s1"], "no scene of this name comes with the project"),
    (["-o", "my.toml"], "needs the name of one scene"), (["s1", "--json"], "is for the list of all scenes")])
def test_scenes_refuses_what_it_cannot_do(tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    assert message in refused(capsys, "scenes", *arguments)
