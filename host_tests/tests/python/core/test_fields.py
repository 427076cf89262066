"""Each field of a vehicle is described once (vehicle.h): nothing is left out of the list, and the rest follows it."""

from __future__ import annotations

import pytest

from laconic.core import Field, load
from laconic.core.fields import COUNTED
from laconic.core.sensors import values_of
from laconic.fmu import DESCRIPTION, start_values
from laconic.scene import read_scene
from laconic.scene.signals import LENGTHS, PER_WHEEL
from laconic_fmu.description import read

STRUCTS = {"vehicle": "laconic_vehicle", "vehicle.payload": "laconic_payload", "vehicle.wheel[#]": "laconic_wheel",
           "vehicle.support[#]": "laconic_support", "ground": "laconic_ground", "vehicle.drive": "laconic_drive",
           "vehicle.motor": "laconic_motor", "initial": "laconic_start",
           "": "laconic_input"}
"""Table of a scene → struct of the core."""


def parameters() -> list[Field]:
    return [field for field in load().fields if field.table and field.table != "vehicle.motor"]


@pytest.mark.parametrize("table", STRUCTS)
def test_every_member_of_a_struct_has_its_row_in_the_list(table: str) -> None:
    core = load()
    members = {name for name, _ in core.ffi.typeof(STRUCTS[table]).fields}
    counted = {*COUNTED, *(f"{name}_count" for name in COUNTED)}
    inner = {"payload", "ground", "drive", *counted} if table == "vehicle" else set()
    assert {field.member for field in core.fields_of(table)} == members - inner, "vehicle.h: member without a row"


def test_every_setting_of_a_sensor_has_its_row_and_its_key() -> None:
    core = load()
    structs = {"sensors.imu": "laconic_imu_settings", "sensors.encoder": "laconic_encoder_settings"}
    for path, struct in structs.items():
        members = {name for name, _ in core.ffi.typeof(struct).fields}
        assert {field.key for field in core.fields_of(path)} - {"wrap"} == members, "sensors.h: member without a row"
    settings = core.ffi.new("laconic_sensor_settings *")
    assert all(len(values_of(field, settings)) == max(field.items, 1) for field in core.sensor_fields)


def test_a_list_has_room_for_as_many_items_as_its_struct() -> None:
    vehicle, start = load().ffi.new("laconic_vehicle *"), load().ffi.new("laconic_start *")
    for field in parameters():
        if field.table != "run":
            assert len(field.values(vehicle if field.table != "initial" else start)) == max(field.items, 1), field


def test_inputs_of_scenes_are_those_of_the_list() -> None:
    known = {field.name: field.items for field in load().fields if not field.table}
    assert known == {**dict.fromkeys(PER_WHEEL, load().max_wheels), **LENGTHS}


def test_every_parameter_is_a_variable_of_the_fmus_and_has_its_start_value_there() -> None:
    variables = {variable.name: variable for variable in read(DESCRIPTION).variables}
    given = start_values(read_scene("s1"))
    for field in parameters():
        assert field.name in variables, f"modelDescription.xml: there is no variable {field.name}"
        assert field.name in given
        assert (variables[field.name].size is None) == (field.items == 0), field.name
    assert not [field.name for field in load().sensor_fields if field.name not in variables or field.name not in given]
