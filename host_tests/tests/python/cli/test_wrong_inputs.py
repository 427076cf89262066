"""Wrong inputs as new users give them, to all commands: one clear line, exit status 2, and nothing made or changed."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import commands, run

EMPTY = "is empty; give a name"
TOML_FAULTS = {"binary.toml": "no text in UTF-8", "nul.toml": "no valid TOML", "utf16.toml": "no text in UTF-8",
               "json.toml": "no valid TOML", "empty.toml": "vehicle: is missing", "folder": "cannot be read",
               "huge.toml": f"run.duration_s: is 1{59 * '0'}…; give a finite",
               "control.toml": "name: holds the control character '\\x1b'",
               "''": EMPTY, ".": "cannot be read", "/dev/null": "vehicle: is missing", "good.toml/x": "no such scene",
               "nowhere": "no such scene", "robotino": "did you mean robotino2?"}
LETTERS = {"\\u0001": "the control character '\\x01'", "\\u001b": "the control character '\\x1b'",
           "\\u2028": "the control character '\\u2028'", "\\uffff": "the unprintable character '\\uffff'",
           "\\u0008": "the control character '\\x08'", "\\U0001fffe": "the unprintable character '\\U0001fffe'"}
OF_SCENE = ("simulate", "derive", "fmu --fmi 2", "analyse", "trim", "rig", "ros2", "demo", "report --scene")

WRONG = {
    # words of the command line
    "nothing": "known are", "simulat s1": "did you mean simulate?", "--nothing": "--nothing",
    "simulate": "SCENE", "simulate s1 s1": "extra argument", "simulate s1 --out": "--out", "simulate -x": "-x",
    "simulate s1 --method ''": "--method", "simulate s1 --real half": "--real", "simulate -- --out": "no such scene",
    "fmu s1": "--fmi", "fmu s1 --fmi 4": "--fmi", "derive": "SCENE or --example", "derive --example no": "--example",
    "derive s1 --example caster": "either", "derive s1 --latex --c": "exclude each other",
    "report s1": "extra argument",
    "benchmark": "WHAT", "benchmark fast": "batch", "benchmark batch --lanes 0": "--lanes",
    "replay log": "LOG", "verify": "REFERENCE",
    "scenes no_such -o my.toml": "known are", "scenes s1 -o s1.fmu": ".toml", "scenes -o my.toml": "NAME",
    "rig s1 --board nothing": "--board", "trim s1 --real 3": "--real", "analyse s1 --only all": "--only",
    # numbers
    "simulate s1 --step abc": "--step", "simulate s1 --step ''": "--step", "simulate s1 --step 0": "--step",
    "simulate s1 --step nan": "--step", "simulate s1 --step 1e400": "--step: inf",
    "simulate s1 --step 1e-320": "run.duration_s", "simulate s1 --step 0.3": "a step of 0.01 s would do",
    "verify no.json --step -1": "--step", "verify no.json --tolerance 0": "--tolerance",
    "verify no.json --tolerance nan": "--tolerance",
    "fmu s1 --fmi 2 --estimate --ssp": "--estimate",
    "rig s1 --steps 0": "--steps", "rig s1 --steps 1.5": "--steps",
    "rig s1 --rate 0 --free-run": "--rate", "rig s1 --bitrate x": "--bitrate",
    "rig s1 --watchdog 70000 --free-run": "--watchdog", "rig s1 --id-base ''": "--id-base",
    "rig s1 --id-base -32": "--id-base",
    "rig s1 --key good.toml": "--interface",
    "rig s1 --key nowhere.key": "nowhere.key",
    "rig s1 --interface virtual --channel x --key good.toml": "32 hexadecimal digits",
    "rig s1 --tolerance nu_1=nan": "nu_1=nan",
    "rig s1 --tolerance nu_1=-1": "nu_1=-1", "analyse s1 --at nan": "--at", "analyse s1 --straight nan 1": "--straight",
    "analyse s1 --straight 1": "--straight", "analyse s1 --start 1e300 0 0": "--start",
    "analyse s1 --from 2 --to 1": "--from 2 --to 1", "analyse s1 --parameter colour": "known are",
    "play": "SCENE", "play s1": "--interface", "play s1 --listen x": "--listen", "play s1 --listen 70000": "protocol",
    "play robotino2 --listen 0 --drives canopn": "--drives", "play robotino2 --listen 0 --step nan": "--step",
    "play robotino2 --listen 0 --drives canopen --duration nan": "--duration",
    "play robotino2 --listen 0 --drives canopen --stop-within nan": "--stop-within",
    "play robotino2 --listen 0 --drives canopen --fault stall:9@1": "wheel 9",
    "play robotino2 --listen 0 --drives canopen --bus-fault los=1": "did you mean loss?",
    "play robotino2 --listen 0 --dbc nowhere.dbc --map nowhere.toml": "nowhere.toml",
    "play robotino2 --listen 0 --drives canopen --log ''": EMPTY, "play robotino2 --eds a.eds --listen 0": "--listen",
    "ros2": "SCENE", "ros2 nowhere": "no such scene", "ros2 robotino2 --rate nan": "--rate: nan",
    "ros2 robotino2 --rate 333": "--rate: a period of 0.003003 s is not a whole number of steps",
    "ros2 robotino2 --rate 3000": "give 1000 Hz", "ros2 robotino2 --step 0": "--step", "ros2 s1 --robots 0": "--robots",
    "ros2 robotino2 --domain 233": "--domain: 233 is not a domain; give 0 to 232",
    "ros2 robotino2 --distro foxy": "'foxy' is not one of",
    "ros2 robotino2 --namespace 'a b'": "--namespace: a b is not a name of ROS",
    "ros2 robotino2 --frame x=y": "--frame: x=y",
    "ros2 robotino2 --frame base": "--frame: base is not NAME=FRAME",
    "ros2 robotino2 --speed 2": "add --sim-time", "ros2 robotino2 --duration nan": "--duration",
    "ros2 robotino2 --map folder --loopback": "folder",
    "ros2 robotino2 --map good.toml": "--map: has a meaning with --loopback alone",
    "ros2 robotino2 --loopback --map good.toml": "good.toml: image: is missing", "ros2 robotino2 --urdf ''": EMPTY,
    "ros2 robotino2 --urdf binary.toml": "binary.toml", "ros2 robotino2 --record good.csv": ".toml",
    "ros2 robotino2 --robots 2 --record a.toml": "--record", "ros2 robotino2 --spacing -1": "--spacing",
    "ros2 robotino2 --rmw opensplice": "--rmw", "ros2 paper_caster --rate 7": "--rate",
    "simulate skid_steer --enclose": "ground.friction_coefficient: wheels stick and slip",
    "simulate switched.toml --enclose": "vehicle.wheel[2].motor_circuit", "verify nowhere --enclose": "no such scene",
    "simulate limited.toml --enclose": "vehicle.drive: limits switch", "verify list.json --enclose": "no object",
    "simulate waves.toml --enclose": "input[1].kind: a sine changes", "verify folder --enclose": "cannot be read",
    "verify waves.toml --enclose": "input[1].kind: a sine changes", "verify s1": "give a reference file",
    "sweep": "-o: is missing", "sweep -o out": "SCENE: is missing", "sweep s1 -o out": "--vary: is missing",
    "sweep s1 --vary vehicle.mas_kg=1,2 -o out": "did you mean mass_kg?", "sweep s1 --vary x -o out": "--vary x",
    "sweep s1 --vary 'vehicle.mass_kg~norml(1,2)' -o out": "did you mean normal?", "sweep --measures s1": "SCENE s1",
    "sweep s1 --vary vehicle.wheel[9].x_m=1,2 -o out": "vehicle.wheel[1] to vehicle.wheel[3]",
    "sweep s1 --vary vehicle.mass_kg=1,2 --measure x -o out": "no such measure",
    "sweep s1 --vary vehicle.mass_kg=1,2 --samples 3 -o out": "--samples 3", "sweep --repeat 0 -o folder": "sweep.json",
    "sweep s1 --vary vehicle.mass_kg=1,2 -o good.toml": "there is a file",
    "sweep nowhere --vary a=1 -o out": "no such scene",
    "sweep s1 --vary vehicle.mass_kg=1,2 --workers 1 --scheduler tcp://x -o out": "exclude each other",
    "sweep s1 --vary vehicle.mass_kg=1,2 --measure supply_energy_J -o out": "vehicle.drive.supply_V",
    "sweep s1 --vary vehicle.mass_kg=1,2 --workers -1 -o out": "--workers", "sweep s1 --scene-out x -o out": ".toml",
    "optimise": "SCENE", "optimise s1": "--free: is missing", "optimise s1 --free vehicle.com_y_m=0:1": "--goal",
    "optimise s1 --free x=0:1 --goal min:condition": "x", "optimise s1 --free vehicle.com_y_m=0:1 --goal x": "min:x",
    "optimise s1 --free vehicle.com_y_m=0:1 --goal min:yaw": "yaw_authority", "optimise nowhere": "no such scene",
    # files to read
    "verify empty.json": "no valid JSON", "verify list.json": "no object with cases", "verify folder": "cannot be read",
    "verify binary.toml": "JSON", "verify nowhere.json": "cannot be read", "verify ''": EMPTY,
    "verify number.json": "format", "replay nowhere.csv robotino2": "cannot be read", "replay '' robotino2": EMPTY,
    "replay empty.csv robotino2": "no samples", "replay binary.toml robotino2": "comes last",
    "replay folder robotino2": "no CSV file", "replay /dev/null robotino2": "no samples",
    "replay empty.csv robotino2 --map good.toml": "time", "replay empty.csv robotino2 --map nowhere": "no such file",
    "replay empty.csv robotino2 --map ''": EMPTY, "replay empty.csv robotino2 --fit ''": EMPTY,
    "identify nowhere.csv --scene robotino2": "cannot be read", "identify empty.csv": "--scene",
    "identify empty.csv --scene robotino2": "no samples", "identify --scene robotino2": "LOG",
    "identify empty.csv --scene robotino2 --free colour": "known are", "identify folder --scene s1": "no CSV file",
    "audit nowhere.csv robotino2": "cannot be read", "audit empty.csv robotino2": "no samples",
    "audit empty.csv": "LOG",
    "audit empty.csv robotino2 --export a.txt": ".yaml", "audit empty.csv robotino2 --map ''": EMPTY,
    "frc nowhere.toml": "no such scene", "frc s1": "frc.drive",
    "frc --new swerve --mass x --bumpers 1x1 --track 0.5 -o a.toml": "mass",
    "logs nowhere.csv": "cannot be read", "logs empty.csv": "is empty", "logs folder": "is a folder", "logs": "LOG",
    "logs empty.csv -o a.txt": ".toml", "logs empty.csv --fields /odom": "has no topics",
    "simulate s1 --bag empty.csv/b": "cannot be written", "simulate s1 --bag ''": EMPTY,
    "import nowhere.urdf -o a.toml": "no such file", "import empty.json -o a.toml": "is no XML",
    "import binary.toml -o a.toml": "is no XML", "import nowhere.xacro -o a.toml": "nowhere.xacro",
    "import empty.csv": "--out", "import empty.csv -o ''": EMPTY, "import folder -o a.toml": "directory",
    "rig s1 --replay nowhere.blf": "nowhere.blf", "rig s1 --replay folder": "folder",
    "rig s1 --replay good.toml": "log",
    "rig s1 --replay ''": EMPTY, "rig s1 --replay empty.asc": "no answer",
    # files to write
    "simulate s1 --out ''": EMPTY, "simulate s1 --plot ''": EMPTY, "derive s1 -o ''": EMPTY,
    "fmu s1 --fmi 2 -o ''": EMPTY, "rig s1 --log ''": EMPTY, "rig s1 --junit ''": EMPTY, "trim s1 --out ''": EMPTY,
    "analyse s1 --out ''": EMPTY, "core --out ''": EMPTY, "demo s1 --out ''": EMPTY, "report --out ''": EMPTY,
    "simulate s1 --out folder": "ends in .csv", "simulate s1 --plot x.gif": "ends in .png",
    "simulate s1 --errors": "has a meaning with --out alone",
    "simulate s1 --out /dev/null/x.csv": "cannot be written", "simulate s1 --out /proc/no/x.csv": "cannot be written",
    "simulate s1 --plot /proc/x.png": "cannot be written", "fmu s1 --fmi 3 -o /proc/x.fmu": "cannot be written",
    "trim s1 --out /proc": "cannot be written",
    "rig s1 --steps 2 --log /proc/x.blf": "cannot be written", "analyse s1 --only geometry --out /proc/x": "written",
    "rig s1 --steps 2 --junit /proc/x.xml": "cannot be written", "demo s1 s1": "where",
}
WRONG |= {f"{command} {name}": words for name, words in TOML_FAULTS.items() for command in OF_SCENE}


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with files that are wrong, each in its way."""
    folder = tmp_path_factory.mktemp("wrong")
    good = scene_path("s1").read_text()
    texts = {"good.toml": good, "empty.toml": "", "json.toml": '{"a": 1}', "empty.json": "", "list.json": "[]",
             "number.json": '{"cases": 3}', "empty.csv": "", "empty.asc": "",
             "huge.toml": good.replace("duration_s = 10.0", "duration_s = 1" + 400 * "0"),
             "control.toml": 'name = "\\u001b[2J"\n' + good.replace("name =", "#")}
    still, end = scene_path("robotino2").read_text().split("[[input]]")[0], "[run]\nduration_s = 1.0\nstep_s = 0.01\n"
    sine = '[[input]]\nsignal = "voltage_V[1]"\nkind = "sine"\namplitude = 1\nfrequency_Hz = 1\n'
    circuit = "bearing_deg = 180.0\n"
    texts |= {"waves.toml": still + sine + end, "limited.toml": f"{still}[vehicle.drive]\nsupply_V = 12\n{end}",
              "switched.toml": still.replace(circuit, f'{circuit}motor_circuit = "open"\n') + end}
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "binary.toml").write_bytes(bytes(range(256)))
    (folder / "nul.toml").write_bytes(bytes(100))
    (folder / "utf16.toml").write_bytes(good.encode("utf-16"))
    (folder / "folder").mkdir()
    return folder


def snapshot(folder: Path) -> dict[str, bytes | None]:
    """Everything in a folder."""
    return {str(path): None if path.is_dir() else path.read_bytes() for path in sorted(folder.rglob("*"))}


@pytest.mark.filterwarnings("error")  # a warning would be a second line
@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_command_line_is_one_line_and_changes_nothing(line, workplace, monkeypatch, capsys):
    monkeypatch.chdir(workplace)
    before = snapshot(workplace)
    assert run(shlex.split(line)) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "unexpected" not in printed.err.replace("unexpected extra", "")
    assert WRONG[line] in printed.err
    assert printed.err.count("\n") == 1
    assert snapshot(workplace) == before


@pytest.mark.parametrize("key", ["name", "source"])
@pytest.mark.parametrize("letter", LETTERS)
def test_a_letter_that_cannot_be_printed_is_refused_in_the_field_that_has_it(
        letter, key, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "x.toml"
    text = "".join(line for line in scene_path("robotino2").read_text().splitlines(keepends=True)
                   if not line.startswith(f"{key} ="))
    path.write_text(f'{key} = "a{letter}b"\n{text}')
    for command in ("fmu {} --fmi 2 --ssp -o x.ssp", "fmu {} --fmi 3 -o x.fmu", "simulate {}", "trim {}"):
        assert run(command.format(path).split()) == 2
        assert f"x.toml: {key}: holds {LETTERS[letter]}" in (printed := capsys.readouterr().err)
        assert printed.count("\n") == 1


def test_a_key_with_control_characters_is_shown_without_them(tmp_path, capsys):
    path = tmp_path / "x.toml"
    path.write_text('"a\\u001b[31mb" = 1\n' + scene_path("s1").read_text())
    assert run(["simulate", str(path)]) == 2
    assert "a\\x1b[31mb: is no known key here" in capsys.readouterr().err


def test_every_command_has_wrong_inputs():
    tried = {line.split()[0] for line in WRONG}
    assert set(commands.list_commands(None)) <= tried
    assert len(WRONG) > 200


@pytest.mark.parametrize("newline, mark", [("\n", ""), ("\r\n", ""), ("\r\n", "\ufeff")])
def test_files_of_other_editors_are_read(newline, mark, tmp_path, capsys):
    path = tmp_path / "röbot ☃.toml"
    path.write_text(mark + scene_path("paper_caster").read_text(), encoding="utf-8", newline=newline)
    assert run(["simulate", str(path)]) == 0


@pytest.mark.filterwarnings("error")
def test_a_name_of_any_letters_is_shown_as_it_stands(tmp_path, capsys):
    name = "[/red] [bold] $x^$ {0} %s \\\\ \U0001f916 ☃"
    path, picture = tmp_path / "own.toml", tmp_path / "☃.png"
    path.write_text(f'name = "{name}"\n' + scene_path("s1").read_text().replace("name =", "#", 1))
    assert run(["simulate", str(path), "--plot", str(picture)]) == 0
    assert picture.stat().st_size > 0
    assert run(["rig", str(path), "--steps", "2"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert printed.out.count("[/red] [bold] $x^$ {0} %s") == 2
