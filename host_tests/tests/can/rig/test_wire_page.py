"""docs/wire.md is made of the contract, its examples are what the node computes, and what it requires the node
does."""

from __future__ import annotations

import ast
import re
import subprocess
import sys

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR, built
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import node_process
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.lockstep import start_of
from laconic.can.rig.node_library import node_library
from laconic.can.rig.parameters import parameters_of
from laconic.can.rig.wire import ID_BASE, wire
from laconic.core.plant import Plant
from laconic.scene import METHODS, read_scene
from laconic_build.wire import document_wire
from laconic_build.wire.wire_parameters import PARAMETERS

FIRMWARE = SOURCE_DIR / "firmware_stub"
PAGE = (SOURCE_DIR / "docs" / "wire.md").read_text(encoding="utf-8")
EXAMPLE = re.compile(r"^\* (\w+)\b.*?(?:count|counter) (\d+).*`((?:[0-9A-F]{2} ?)+)`$", re.MULTILINE)


def test_the_page_is_made_from_the_contract_of_today() -> None:
    assert document_wire.page() == PAGE, "run python -m laconic_build.wire.document_wire"


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
              if not row[3].startswith("not") and not row[0].startswith(("rig.drives", "sensors"))}
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


@pytest.mark.parametrize("real", ["double", "single"])
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
