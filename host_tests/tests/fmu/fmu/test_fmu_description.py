"""The descriptions: one source, complete, valid for every checker."""

from __future__ import annotations

import re
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import generic
from lxml import etree

from laconic.core import load
from laconic.fmu import DESCRIPTION, make_fmu
from laconic.scene import METHODS, read_scene
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic_fmu import fmi2, fmi3
from laconic_fmu.description import read, token_in, token_of
from laconic_fmu.for_vehicle import for_vehicle

DESIGN_NAMES = """
    mass_kg yaw_inertia_kgm2 com_x_m com_y_m com_z_m friction_coefficient wheel_radius_m wheel_inertia_kgm2
    motor_gain_Nm_per_V motor_damping_Nms payload_mass_kg payload_x_m payload_y_m payload_yaw_inertia_kgm2 wheel_count
    wheel_kind wheel_x_m wheel_y_m axle_rad roller_rad wheel_locked start_nu_rad_per_s start_x_m start_y_m
    start_heading_rad method step_s voltage_V axle_torque_Nm body_force_N body_moment_Nm world_force_N
    world_force_point_m nu_rad_per_s x_m y_m heading_rad heading_wrapped_rad origin_x_m origin_y_m
    velocity_body_m_per_s yaw_rate_rad_per_s wheel_speed_rad_per_s wheel_angle_rad wheel_torque_Nm wheel_reaction_N
    wheel_lateral_N no_slip_margin_N energy_J support_count support_x_m support_y_m""".split()

VARIANTS = [(2, False), (3, False), (3, True)]
SCENES = ("robotino2", "turtlebot3_burger", "kuka_youbot", "paper_caster")


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Every variant of some scenes, and the generic ones."""
    folder = tmp_path_factory.mktemp("fmus")
    made = [make_fmu(read_scene(name), folder / f"{name}_{version}{scalar}.fmu", version=version, scalar=scalar)
            for name in SCENES for version, scalar in VARIANTS]
    return [generic(2), generic(3), *made]


def test_every_name_of_the_contract_is_there() -> None:
    assert set(DESIGN_NAMES) <= {variable.name for variable in read(DESCRIPTION).variables}


def test_the_shipped_descriptions_are_the_source_without_friction_and_sensors() -> None:
    ideal = for_vehicle(read(DESCRIPTION))
    with zipfile.ZipFile(generic(3)) as archive:
        assert archive.read("modelDescription.xml").decode("utf-8") == fmi3.describe(ideal)
    with zipfile.ZipFile(generic(2)) as archive:
        shipped = archive.read("modelDescription.xml").decode("utf-8")
    files = [file.get("name", "") for file in ET.fromstring(shipped).findall("CoSimulation/SourceFiles/File")]
    assert shipped == fmi2.describe(ideal, files)


def test_the_generic_vehicle_is_mounted_right(tmp_path: Path) -> None:
    start = {variable.name: variable.start for variable in read(DESCRIPTION).variables}
    assert set(start["wheel_kind"]) == {"1"}  # roller
    names = [field.name for field in load().fields_of("vehicle")]
    plain = "".join(f"{name} = {start[name][0]}\n" for name in names)
    rows = zip(start["wheel_x_m"], start["wheel_y_m"], start["axle_rad"], start["roller_rad"], strict=True)
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "roller"\nx_m = {x}\ny_m = {y}\naxle_rad = {axle}\n'
                     f"roller_rad = {roller}\n" for x, y, axle, roller in rows)
    scene = tmp_path / "generic.toml"
    scene.write_text(f'name = "generic"\nsource = "the description"\n[vehicle]\n{plain}{wheels}'
                     "[run]\nduration_s = 1.0\nstep_s = 0.01\n")
    found = diagnose(subject_of(read_scene(scene)))
    assert found.mirrored_yaw_authority < found.yaw_authority
    assert found.rank == 3


def test_the_fmu_of_a_scene_reports_what_it_is_and_where_its_numbers_come_from(fmus: list[Path]) -> None:
    for fmu in fmus[2:]:
        root = fmpy.read_model_description(str(fmu), validate=False)
        scene = read_scene(fmu.name.rpartition("_")[0])
        assert root.modelName == scene.name
        assert root.description == f"Dynamics of a wheeled robot; its numbers: {scene.source}"


def test_the_token_belongs_to_the_text() -> None:
    text = DESCRIPTION.read_text(encoding="utf-8")
    assert token_in(text) == token_of(text)


def test_value_references_of_an_arrays_elements_follow_each_other(fmus: list[Path]) -> None:
    for fmu in fmus:
        described = fmpy.read_model_description(str(fmu), validate=False)
        if described.fmiVersion != "2.0" and "True" not in fmu.name:
            continue  # with arrays
        references = {v.name: v.valueReference for v in described.modelVariables}
        assert len(set(references.values())) == len(references)
        assert references["mass_kg"] == 2
        pairs = [(re.sub(r"\[(\d+)\]", lambda found: f"[{int(found[1]) + 1}]", name), reference)
                 for name, reference in references.items() if "[" in name]
        assert len([1 for following, _ in pairs if following in references]) > 10
        for following, reference in pairs:
            assert references.get(following, reference + 1) == reference + 1, following


def test_fmpy_validates_every_variant_without_a_message(fmus: list[Path]) -> None:
    assert {str(fmu): validate_fmu(str(fmu)) for fmu in fmus} == {str(fmu): [] for fmu in fmus}


@pytest.mark.nightly
def test_the_manipulation_toolbox_has_no_finding(fmus: list[Path]) -> None:
    tool = Path(sys.executable).parent / "fmutool"
    for fmu in fmus[:5]:
        done = subprocess.run([str(tool), "-input", str(fmu), "-check"], capture_output=True, text=True, check=True)
        lines = (done.stdout + done.stderr).splitlines()
        assert any("compliant with FMI" in line for line in lines), lines
        assert any("No semantic error" in line for line in lines), lines
        assert not [line for line in lines if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


def test_every_number_has_unit_nominal_or_range_and_every_variable_a_description() -> None:
    description = read(DESCRIPTION)
    for variable in description.variables:
        assert len(variable.description) > 3, variable.name
        if variable.tag == "Float64":
            assert "declaredType" in variable.attributes, variable.name
    root = ET.fromstring(DESCRIPTION.read_text(encoding="utf-8"))
    units = {kind.get("name"): kind.get("unit") for kind in root.find("TypeDefinitions") if kind.tag == "Float64Type"}
    assert [name for name, unit in units.items() if unit is None] == ["Ratio"]
    for suffix, unit in (("_m", "m"), ("_rad", "rad"), ("_rad_per_s", "rad/s"), ("_kg", "kg"), ("_N", "N"), ("_V", "V"),
                         ("_Nm", "N.m"), ("_J", "J"), ("_m_per_s", "m/s"), ("_s", "s"), ("_kgm2", "kg.m2")):
        for variable in description.variables:
            longer = [s for s in ("_m_per_s", "_rad_per_s", "Nm_per_V") if variable.name.endswith(s) and s != suffix]
            if variable.name.endswith(suffix) and not longer:
                assert units[variable.attributes["declaredType"]] == unit, variable.name


def test_a_scene_fmu_starts_with_the_scene(tmp_path: Path) -> None:
    scene = read_scene("turtlebot3_burger")
    fmu = make_fmu(scene, tmp_path / "burger.fmu", version=2)
    variables = {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}
    assert float(variables["mass_kg"].start) == scene.vehicle["mass_kg"]
    assert variables["wheel_kind[1]"].start == "2"
    assert variables["wheel_count"].start == "2"
    assert variables["wheel_count"].variability == "constant"
    assert "wheel_x_m[3]" not in variables


def test_terminals_icon_documentation_and_licence_are_inside(fmus: list[Path]) -> None:
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"))
    for fmu in fmus:
        with zipfile.ZipFile(fmu) as archive:
            names = set(archive.namelist())
            assert {"documentation/index.html", "documentation/licenses/license.txt"} <= names
            variables = {v.name for v in fmpy.read_model_description(str(fmu), validate=False).modelVariables}
            if "model.png" in names:
                continue
            assert {"terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"} <= names
            terminals = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
            schema.assertValid(terminals)
            members = [member.get("variableName") for member in terminals.iter("TerminalMemberVariable")]
            assert members
            assert set(members) <= variables


def test_the_build_description_is_valid_and_names_the_compiler_with_its_options() -> None:
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3BuildDescription.xsd"))
    with zipfile.ZipFile(generic(3)) as archive:
        text = archive.read("sources/buildDescription.xml")
        files = set(archive.namelist())
    schema.assertValid(root := etree.fromstring(text))
    for group in root.iter("SourceFileSet"):
        assert group.get("compiler") == "gcc"
        assert "-ffp-contract=off" in group.get("compilerOptions")
    assert {f"sources/{file.get('name')}" for file in root.iter("SourceFile")} <= files


def test_the_archive_is_the_same_every_time(tmp_path: Path) -> None:
    scene = read_scene("robotino2")
    first, second = (make_fmu(scene, tmp_path / name, version=3).read_bytes() for name in ("a.fmu", "b.fmu"))
    assert first == second


@pytest.mark.parametrize(("version", "scalar"), VARIANTS)
def test_without_sources_an_fmu_is_small(version: int, scalar: bool, tmp_path: Path) -> None:
    fmu = make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=version, scalar=scalar, sources=False)
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        assert not [name for name in archive.namelist() if name.startswith("sources/")]
    assert fmu.stat().st_size < 113_000 + 3_000 * (len(METHODS) - 8)  # all methods are inside
