"""Who may command: codes against another implementation, and a node that takes commands of the key's holder alone."""

import random
import re
from pathlib import Path

import can
import pytest
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.cmac import CMAC

from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.buses import node_process
from laconic.can.rig.codes import Codes
from laconic.can.rig.node_library import node_library
from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.errors import ResultFails

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
    text = (SOURCE_DIR / "docs" / "secure.md").read_text(encoding="utf-8")
    node, rig = (match.split() for match in re.findall(r"^    (laconic.* --key robot.key)$", text, re.MULTILINE))
    assert node[0] == "laconic-node-double"
    with node_process("double", ID_BASE, *(word.replace("robot.key", key_files[0]) for word in node[1:])) as port:
        assert run([word.replace("PORT", str(port)).replace("robot.key", key_files[0]) for word in rig[1:]]) == 0


def test_a_rig_with_a_key_drives_a_node_without_one(key_files: tuple[str, str]):
    with node_process() as port:
        assert drive(port, "--key", key_files[0]) == 0


@pytest.mark.parametrize("text", ["", "00", "0" * 31, "0" * 33, "g" * 32])
def test_a_file_that_holds_no_key_is_named(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "bad.key"
    path.write_text(text, encoding="ascii")
    assert drive(1, "--key", str(path)) == 2
    assert "bad.key" in capsys.readouterr().err
