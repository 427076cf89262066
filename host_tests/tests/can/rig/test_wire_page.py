"""docs/wire.md is made of the contract, its examples are what the node computes, and what it requires the node
does."""

from __future__ import annotations

import ast
import os
import random
import re
import subprocess
import sys
from pathlib import Path

import can
import numpy as np
import pytest
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.cmac import CMAC

from laconic.base.paths import SOURCE_DIR, built
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import node_process
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.lockstep import start_of
from laconic.can.rig.node_library import node_library
from laconic.can.rig.parameters import parameters_of
from laconic.can.rig.session import Codes
from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.core.plant import Plant
from laconic.errors import ResultFails
from laconic.scene import METHODS, read_scene
from laconic_build.wire import document_wire
from laconic_build.wire.wire_parameters import PARAMETERS

FIRMWARE = SOURCE_DIR / "firmware_stub"
PAGE = (SOURCE_DIR / "docs" / "wire.md").read_text(encoding="utf-8")
EXAMPLE = re.compile(r"^\* (\w+)\b.*?(?:count|counter) (\d+).*`((?:[0-9A-F]{2} ?)+)`$", re.MULTILINE)


def test_the_page_is_made_from_the_contract_of_today() -> None:
    assert document_wire.page() == PAGE, "run python -m laconic_build.wire.document_wire"


def test_the_command_that_the_pages_name_makes_the_page_from_the_root_alone() -> None:
    code = "from laconic_build.wire import document_wire; print(document_wire.page() == document_wire.PAGE.read_text())"
    done = subprocess.run([sys.executable, "-c", code], cwd=SOURCE_DIR, capture_output=True, text=True, check=False,
                          env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"})
    assert done.stdout == "True\n", done.stderr


def test_the_worked_examples_are_what_the_node_computes() -> None:
    library, found = node_library("double"), EXAMPLE.findall(PAGE)
    nonce, session, start = 0x0123ABCD, 0xC0FFEE11, 9
    key = library.lib.laconic_mix(session, nonce)
    keys = {"nonce": nonce, "session": key, "run": library.lib.laconic_run_key(key, start)}
    assert f"0x{key:08X}" in PAGE and f"0x{keys['run']:08X}" in PAGE
    assert [name for name, _, _ in found] == ["HELLO", "OPEN", "CONTROL", "VOLTAGE", "VOLTAGE_FD", "NU"]
    for name, count, text in found:
        data, frame = bytearray.fromhex(text), wire()[name]
        if frame.key == "none":
            assert library.plain_is_right(frame.offset, data), name
        else:
            assert library.keyed_is_right(frame.offset, data, keys[frame.key], int(count)), name
        assert frame.counter_of(data) == int(count) & (255 if frame.fd else 15)
    assert wire()["VOLTAGE"].physical(bytes.fromhex(found[3][2]))["voltage_2"] == 10.0


def test_every_enumeration_and_every_frame_stands_on_the_page() -> None:
    for frame in wire().frames.values():
        assert f"0x{ID_BASE + frame.offset:X} | [{frame.name}]" in PAGE
        assert frame.attributes["E2EDataID"] in PAGE
        for field in frame.fields.values():
            assert all(text in PAGE for text in field.choices.values() if text != "NONE")
    assert all(f"{number} {name}" in PAGE for number, name in enumerate(METHODS))


def test_the_node_requires_what_the_page_states_and_nothing_else() -> None:
    """Each number of a vehicle that has all of them is left out once."""
    scene = read_scene("s1")
    plant: Plant = scene.plant(scene.core())
    vehicle = plant.c.vehicle
    vehicle.payload.mass_kg, vehicle.support_count, vehicle.wheel[0].locked = 1.0, 1, True
    vehicle.wheel[1].undriven = True
    for field in scene.core().own_fields():
        setattr(vehicle.wheel[0], field.member, 0.05)
    for table, struct in (("vehicle", vehicle), ("ground", vehicle.ground), ("vehicle.drive", vehicle.drive)):
        for field in scene.core().fields_of(table):
            if field.need == "NEVER":
                setattr(struct, field.key, 0.5)
    plant.c.friction.acts, vehicle.wheel[0].motor_circuit = True, 1
    start = start_of(scene)
    start.wheel_speed_rad_per_s[0] = 1.0
    start.x_m = start.y_m = start.heading_rad = start.nu_rad_per_s[0] = 1.0
    whole = list(parameters_of(plant, start))
    loaded = {field for field, row in PARAMETERS.items()
              if not row[3].startswith("not") and not row[0].startswith(("rig.drives", "sensors", "hinges"))}
    assert {field for field, _, _ in whole} == loaded
    with own_node("virtual", "double") as node:
        for left_out in whole:
            missing = None
            try:
                node.load_parameters([each for each in whole if each != left_out], np.dtype(np.float64))
            except NodeRefused as refused:
                missing = (refused.field, refused.item) if refused.status == "parameter missing" else None
            needed = bool(PARAMETERS[left_out[0]][3])
            assert missing == ((left_out[0].lower().replace("_", " "), left_out[1]) if needed else None), left_out


def test_reserved_numbers_are_refused_by_name() -> None:
    with own_node("virtual", "double") as node:
        for field, (_, _, item, required) in PARAMETERS.items():
            if required.startswith("not yet"):
                with pytest.raises(NodeRefused, match=f"not supported, {field.lower().replace('_', ' ')}"):
                    node.load_parameters([(field, int(item == "wheel"), 0.0)], np.dtype(np.float64))


# ---- the reference client


def test_the_reference_client_uses_nothing_of_ours() -> None:
    tree = ast.parse((FIRMWARE / "reference_client.py").read_text(encoding="utf-8"))
    imported = {name.name.partition(".")[0] for node in ast.walk(tree) if isinstance(node, ast.Import)
                for name in node.names}
    imported |= {node.module.partition(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported - set(sys.stdlib_module_names) == {"can", "cantools"}


@pytest.mark.parametrize("real", ["double", pytest.param("single", marks=pytest.mark.nightly)])
def test_the_reference_client_drives_a_node_process_in_lockstep_and_in_free_run(real: str) -> None:
    with node_process(real) as port:
        done = subprocess.run([sys.executable, str(FIRMWARE / "reference_client.py"), "--channel",
                               f"socket://127.0.0.1:{port}"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "lockstep: after 2 s at x = 0.230 m, y = 0.124 m, heading 0.987 rad" in done.stdout
    assert "free run: after 50 poses at x = 0.06" in done.stdout


@pytest.mark.parametrize("ending", ["c", "h"])
def test_the_c_of_the_contract_does_not_tell_when_it_was_made(ending):
    head = built(f"firmware_stub/wire/laconic_dbc.{ending}").read_text(encoding="utf-8")[:200]
    assert re.search(r"generated by cantools version [\d.]+\.\n", head)


# ---- Who may command: codes against another implementation, and a node that takes commands of the key's holder
# alone.

KEY, OTHER = bytes(range(16)), bytes(range(1, 17))
CHALLENGE = can.Message(arbitration_id=ID_BASE + 13, is_extended_id=False, data=bytes((0, 0, 7, 0, 0, 9, 0, 0)))
NONCE = 0x09000007


def peer_cmac(key: bytes, message: bytes) -> bytes:
    code = CMAC(AES(key))
    code.update(message)
    return code.finalize()


def our_cmac(key: bytes, message: bytes) -> bytes:
    library = node_library()
    prepared, made = library.ffi.new("laconic_cmac_key *"), library.ffi.new("uint8_t[16]")
    library.lib.laconic_cmac_key_of(prepared, key)
    library.lib.laconic_cmac(prepared, message, len(message), made)
    return bytes(made)


def test_codes_are_those_of_another_implementation_at_every_length():
    numbers = random.Random(4493)
    for length in [*range(81), *(numbers.randrange(5000) for _ in range(40))]:
        key, message = numbers.randbytes(16), numbers.randbytes(length)
        assert our_cmac(key, message) == peer_cmac(key, message), length


def test_a_frame_of_the_rig_has_a_code_behind_it_as_the_page_lays_it_out():
    codes = Codes(KEY, ID_BASE)
    codes.heard(CHALLENGE)
    control = can.Message(arbitration_id=ID_BASE + 2, is_extended_id=False, data=bytes(range(8)))
    for count in range(1, 300):
        behind = codes.behind(control)
        assert behind is not None and behind.arbitration_id == ID_BASE + 31
        assert behind.data[:2] == bytes((2, count & 255))
        message = (ID_BASE + 2).to_bytes(2, "big") + bytes(control.data) + (NONCE << 32 | count).to_bytes(8, "big")
        assert behind.data[2:] == peer_cmac(KEY, message)[:6]
    hello = can.Message(arbitration_id=ID_BASE + wire()["HELLO"].offset, is_extended_id=False, data=bytes(8))
    assert codes.behind(hello) is None


def test_a_session_whose_codes_are_used_up_is_refused_and_a_new_challenge_mends_it():
    codes = Codes(KEY, ID_BASE)
    codes.heard(CHALLENGE)
    control = can.Message(arbitration_id=ID_BASE + 2, is_extended_id=False, data=bytes(8))
    hello = can.Message(arbitration_id=ID_BASE + wire()["HELLO"].offset, is_extended_id=False, data=bytes(8))
    codes._gate.freshness = NONCE << 32 | 0xFFFFFFFE
    assert codes.behind(control) is not None
    with pytest.raises(ResultFails, match="connect again"):
        codes.behind(control)
    assert codes.behind(hello) is None
    other = can.Message(arbitration_id=ID_BASE + 13, is_extended_id=False, data=bytes((0, 0, 8, 0, 0, 9, 0, 0)))
    codes.heard(other)
    assert codes.behind(control) is not None


@pytest.fixture
def key_files(tmp_path: Path) -> tuple[str, str]:
    paths = tmp_path / "mine.key", tmp_path / "other.key"
    for path, key in zip(paths, (KEY, OTHER), strict=True):
        path.write_text(key.hex() + "\n", encoding="ascii")
    return str(paths[0]), str(paths[1])


def drive(port: int, *arguments: str) -> int:
    return run(["rig", "s1", "--steps", "20", "--interface", "slcan", "--channel", f"socket://127.0.0.1:{port}",
                *arguments])


def told(last_words: list[str]) -> dict[str, int]:
    lines = (line.rpartition(": ") for line in last_words[0].splitlines() if ": " in line)
    return {name: int(count) for name, _, count in lines}


@pytest.mark.nightly
def test_the_keys_holder_drives_and_nobody_else(key_files: tuple[str, str], capsys: pytest.CaptureFixture[str]):
    mine, other = key_files
    last_words: list[str] = []
    with node_process("double", ID_BASE, "--key", mine, last_words=last_words) as port:
        assert drive(port, "--key", mine) == 0
        assert drive(port, "--key", mine, "--same-bits") == 0
        assert drive(port) == 2
        assert drive(port, "--key", other) == 2
        assert drive(port, "--key", mine) == 0
    counts = told(last_words)
    assert counts["accepted"] > 100 and counts["wrong key or changed message"] > 0 and counts["without a code"] > 0
    assert counts["replayed message"] == counts["old freshness"] == 0
    assert capsys.readouterr().err.count("\n") == 2


def test_the_pages_commands_run(key_files: tuple[str, str]):
    text = (SOURCE_DIR / "docs" / "rig-ports.md").read_text(encoding="utf-8")
    node, rig = (match.split() for match in re.findall(r"^    (laconic.* --key robot.key)$", text, re.MULTILINE))
    assert node[0] == "laconic-node-double"
    with node_process("double", ID_BASE, *(word.replace("robot.key", key_files[0]) for word in node[1:])) as port:
        words = [word.replace("PORT", str(port)).replace("robot.key", key_files[0]) for word in rig[1:]]
        assert run([*words, "--steps", "200"]) == 0


def test_a_rig_with_a_key_drives_a_node_without_one(key_files: tuple[str, str]):
    with node_process() as port:
        assert drive(port, "--key", key_files[0]) == 0


@pytest.mark.parametrize("text", ["", "00", "0" * 31, "0" * 33, "g" * 32])
def test_a_file_that_holds_no_key_is_named(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "bad.key"
    path.write_text(text, encoding="ascii")
    assert drive(1, "--key", str(path)) == 2
    assert "bad.key" in capsys.readouterr().err
