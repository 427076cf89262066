"""The EDS file says what the drive answers: both come from one table."""

from __future__ import annotations

from configparser import ConfigParser
from pathlib import Path

import canopen
import pytest
from canopen.objectdictionary import ODVariable
from canopen_bus import Played, download, played_on_canopen

from laconic.base.paths import SCENE_DIR
from laconic.can.play.canopen_eds import EdsDrive, eds_of_scene, eds_text
from laconic.cli.main import run
from laconic.scene import read_scene

SIZES = {2: 1, 3: 2, 4: 4, 5: 1, 6: 2, 7: 4}
STRING = 9
TOO_LONG, TOO_SHORT, READ_ONLY, TOO_HIGH, TOO_LOW = 0x06070012, 0x06070013, 0x06010002, 0x06090031, 0x06090032


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    with played_on_canopen(read_scene(SCENE_DIR / "robotino2.toml"), tmp_path_factory.mktemp("eds")) as found:
        yield found


def variables(od: canopen.ObjectDictionary) -> list[ODVariable]:
    """Every sub-index that an SDO reaches."""
    found = [each for entry in od.values() for each in
             ([entry] if isinstance(entry, ODVariable) else entry.values())]
    return [each for each in found if each.index >= 0x1000]


def abort_code(action) -> int:
    with pytest.raises(canopen.SdoAbortedError) as refused:
        action()
    return refused.value.code


def test_the_dictionary_of_the_file_is_that_of_the_drive(played: Played) -> None:
    node = played.node(1)
    listed = variables(node.object_dictionary)
    assert len(listed) > 120
    for each in listed:
        if not each.readable or (each.index, each.subindex > 0) == (0x1003, True):  # a history that is empty
            continue
        data = node.sdo.upload(each.index, each.subindex)
        if each.data_type == STRING:
            assert data.decode("ascii").isprintable() and len(data) > 4
            continue
        assert len(data) == SIZES[each.data_type], each
        if each.default is not None:
            assert each.decode_raw(data) == each.default, each


def test_an_object_that_the_file_does_not_list_is_not_there(played: Played) -> None:
    node = played.node(2)
    listed = {(each.index, each.subindex) for each in variables(node.object_dictionary)}
    for index in (*range(0x1000, 0x1030), *(base + k for base in range(0x1400, 0x1C00, 0x200) for k in range(6)),
                  *range(0x6000, 0x6100), 0x2000, 0x6502, 0x6503, 0x9FFF):
        for sub in (0, 1, 3, 6):
            if (index, sub) not in listed:
                assert abort_code(lambda at=(index, sub): node.sdo.upload(*at)) in (0x06020000, 0x06090011)


def test_lengths_and_access_are_those_of_the_file(played: Played) -> None:
    node = played.node(3)
    for each in variables(node.object_dictionary):
        at = each.index, each.subindex
        if not each.writable:
            assert abort_code(lambda at=at: download(node, *at, bytes(4))) == READ_ONLY
        else:
            size = SIZES[each.data_type]
            assert abort_code(lambda at=at, size=size: download(node, *at, bytes(size + 1))) == TOO_LONG
            if size > 1:
                assert abort_code(lambda at=at, size=size: download(node, *at, bytes(size - 1))) == TOO_SHORT


def test_limits_are_those_of_the_file(played: Played) -> None:
    node = played.node(3)
    limited = [each for each in variables(node.object_dictionary) if each.min is not None]
    assert len(limited) > 10
    for each in limited:
        at = each.index, each.subindex
        for value in (each.min, each.max):
            download(node, *at, each.encode_raw(value))
        size, signed = SIZES[each.data_type], each.data_type <= 4
        least, most = (-(1 << 8 * size - 1), (1 << 8 * size - 1) - 1) if signed else (0, (1 << 8 * size) - 1)
        for beyond, code in ((each.max + 1, TOO_HIGH), (each.min - 1, TOO_LOW)):
            if least <= beyond <= most:
                data = beyond.to_bytes(size, "little", signed=signed)
                assert abort_code(lambda at=at, data=data: download(node, *at, data)) == code, each


def test_cob_ids_of_the_file_follow_the_node_id(tmp_path: Path) -> None:
    path = tmp_path / "drive.eds"
    path.write_text(eds_text(7, EdsDrive(encoder_counts=10000)), encoding="ascii")
    od = canopen.import_od(str(path))
    assert od.node_id == 7 and od[0x1400][1].default == 0x207 and od[0x1801][1].default == 0x40000287
    assert od[0x1014].default == 0x87 and od[0x608F][1].default == 10000
    other = canopen.import_od(str(path), node_id=9)
    assert other[0x1A03][1].default == 0x60F40020 and other[0x1803][1].default == 0xC0000489


def test_play_writes_the_file_for_the_drives_of_a_scene_and_refuses_other_protocols(tmp_path: Path, capsys) -> None:
    path = tmp_path / "own.eds"
    assert run(["play", "canopen_agv", "--eds", str(path)]) == 0
    assert canopen.import_od(str(path), node_id=4)[0x608F][1].default == 30
    assert run(["play", "robomaster_mecanum", "--eds", str(path)]) == 2
    assert "--drives canopen" in capsys.readouterr().err


def test_windows_of_a_coarse_encoder_are_a_small_part_of_its_speed_range() -> None:
    """Thirty counts a turn: the usual 500 counts/s would be the whole range of the drive."""
    eds = ConfigParser()
    eds.read_string(eds_of_scene(read_scene("canopen_agv"), "canopen"))
    found = {index: int(eds[index]["DefaultValue"], 0) for index in ("6067", "606D", "606F")}
    assert found == {"6067": 1, "606D": 4, "606F": 1}
