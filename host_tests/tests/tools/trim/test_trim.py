"""The core for one scene alone: leaves out what the scene does without, and gives the same bits as the whole one."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from friction_scenes import skid_steering, slipping
from laconic.base.paths import SOURCE_DIR, build_dir, built
from laconic.cli.main import run
from laconic.core import load
from laconic.core.articulated import ArticulatedVehicle
from laconic.errors import ResultFails
from laconic.scene import METHODS, Outputs, Scene, read_scene
from laconic.scene.inputs import Input
from laconic.scene.methods import EXACT, EXPLICIT
from laconic.simulation import advance_plant
from laconic.simulation.articulated import start_plant
from laconic.simulation.steering import Commands
from laconic.tools.report.boards import board_row
from laconic.tools.report.counting import host_state
from laconic.tools.report.workshop import HOST, M4F, Variant, Workshop, run_tool
from laconic.tools.trim import needs_of, trimmed
from laconic.tools.trim.scene_files import initializer

needs_gcc = pytest.mark.skipif(not HOST.present, reason="no gcc here")
needs_board = pytest.mark.skipif(not M4F.present, reason="no arm-none-eabi-gcc or qemu-system-arm here")
METHOD_SYMBOLS = {f"laconic_{name.replace('-', '_')}" for name in METHODS}


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("bench"))


def nu_only(scene: Scene) -> Scene:
    return replace(scene, outputs=Outputs(signals=("nu_rad_per_s[1]",)))


def test_a_scene_with_voltages_needs_voltages_and_nothing_else_that_acts():
    needs = needs_of(read_scene("s1"))
    assert needs.voltage
    others = (needs.axle_torque, needs.body_wrench, needs.world_force, needs.sampled_input)
    assert not any(others)


def test_damping_is_left_out_only_where_motors_do_not_damp():
    coasting = replace(read_scene("s1"), inputs=())
    assert needs_of(coasting).damping
    assert not needs_of(read_scene("paper_three_wheel_free")).damping


def test_pose_and_wheel_angles_are_left_out_only_where_outputs_name_neither():
    scene = read_scene("s1")
    everything, little = needs_of(scene), needs_of(nu_only(scene))
    assert (everything.pose, everything.wheel_angles) == (True, True)
    assert (little.pose, little.wheel_angles) == (False, False)


def test_a_force_fixed_in_the_world_needs_the_heading():
    scene = nu_only(read_scene("s1"))
    pushed = replace(scene, inputs=(Input("world_force_N[1]", "steps", "input[1]", (0.0,), (1.0,)),))
    assert needs_of(pushed).pose


def test_a_sine_is_sampled_inside_the_step():
    scene = read_scene("s1")
    waved = replace(scene, inputs=(Input("voltage_V[1]", "sine", "input[1]", amplitude=1.0, frequency_Hz=1.0),))
    assert needs_of(waved).sampled_input


def test_the_constant_tables_hold_the_prepared_structs_to_the_last_bit(tmp_path: Path):
    if not HOST.present:
        pytest.skip("no gcc here")
    scene = read_scene("robotino2")
    files, plant = trimmed(scene, "double"), scene.plant(load("double"))
    files.write(tmp_path)
    (tmp_path / "dump.c").write_text(
        '#include <stdio.h>\n#include "laconic_scene_model.h"\nint main(void) {\n'
        "    const unsigned char *bytes = (const unsigned char *)&laconic_scene_model;\n"
        '    for (size_t i = 0; i < sizeof laconic_scene_model; i++) printf("%02x", bytes[i]);\n    return 0;\n}\n')
    include = Path(__file__).resolve().parents[4] / "core_c" / "include"
    names = METHOD_SYMBOLS | {"laconic_auto_slow", "laconic_auto_fast"}
    stubs = "".join(f"const laconic_method {name} = {{0}};\n" for name in sorted(names))
    (tmp_path / "methods.c").write_text('#include "laconic/laconic.h"\n' + stubs)
    run_tool(["gcc", "-std=c99", f"-I{include}", f"-I{tmp_path}", "dump.c", "methods.c", "laconic_scene_model.c", "-o",
              "dump"], tmp_path)
    expected = bytes(load("double").ffi.buffer(load("double").ffi.addressof(plant.c, "model")))
    assert bytes.fromhex(run_tool([str(tmp_path / "dump")])) == expected


@pytest.mark.nightly
@needs_gcc
def test_a_workshop_may_be_named_by_a_relative_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    assert Workshop(Path("bench")).host_program(Variant(read_scene("s1"), "double", trim=True)).is_file()


@needs_gcc
@pytest.mark.parametrize(("name", "real"), [
    ("s1", "double"), *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("paper_caster", "double"), ("turtlebot3_burger", "single"), ("example_two_wheel_sizes", "double")))])
def test_a_trimmed_core_gives_the_same_bits_as_the_whole_one(workshop: Workshop, name: str, real: str):
    scene = read_scene(name)
    whole, trim = (workshop.host_program(Variant(scene, real, "-O0", trim)) for trim in (False, True))
    assert host_state(whole, 700) == host_state(trim, 700)


@needs_gcc
@pytest.mark.parametrize(("made", "real"), [
    pytest.param(skid_steering, "double", marks=pytest.mark.nightly), (slipping, "single")],
                         ids=["skid_steering", "slipping"])
def test_a_trimmed_core_with_friction_gives_the_same_bits_as_the_whole_one(
        workshop: Workshop, made: Callable[[Path], Scene], real: str, tmp_path: Path):
    scene = made(tmp_path)
    whole, trim = (host_state(workshop.host_program(Variant(scene, real, "-O0", trim)), 700) for trim in (False, True))
    assert whole == trim
    assert sum(line.startswith("wheel_speed") for line in whole) == scene.wheel_count


@pytest.mark.nightly
@needs_gcc
def test_a_trimmed_core_with_friction_ends_where_the_plant_does(workshop: Workshop, tmp_path: Path):
    scene = slipping(tmp_path)
    lines = host_state(workshop.host_program(Variant(scene, "double", "-O0", True)), 700)
    plant, inputs = scene.plant(load("double")), scene.inputs_on_grid()
    advance_plant(plant, inputs, 0, 700)
    speeds = [line.split()[1] for line in lines if line.startswith("wheel_speed")]
    assert speeds == [np.array(speed).byteswap().tobytes().hex() for speed in plant.wheel_speeds()]


@pytest.mark.nightly
@needs_board
def test_on_a_cortex_m4f_a_friction_step_has_the_hosts_bits_and_nothing_foreign_is_linked(
        workshop: Workshop, tmp_path: Path):
    row = board_row(workshop, M4F, Variant(slipping(tmp_path), "single", "-Os", True))
    assert row["same_bits"] and row["chosen"] == "friction"
    assert row["double_helpers"] == 0 and row["heap"] == 0 and row["static_ram"] == 0


@needs_gcc
def test_a_scene_without_friction_links_nothing_of_it(workshop: Workshop):
    program = workshop.host_program(Variant(read_scene("s1"), "double", "-O0", True))
    assert not [name for name in run_tool(["nm", str(program)]).split() if "friction" in name]


@needs_gcc
def test_without_pose_the_velocities_still_have_the_same_bits(workshop: Workshop, tmp_path: Path):
    scene = read_scene("paper_three_wheel_free")
    whole = host_state(workshop.host_program(Variant(scene, "double", "-O0")), 500)
    small = host_state(Workshop(tmp_path).host_program(Variant(nu_only(scene), "double", "-O0", True)), 500)
    assert small == tuple(line for line in whole if line.startswith("zeta"))


@needs_gcc
def test_only_the_scenes_method_is_linked_and_no_preparation(workshop: Workshop):
    scene = read_scene("paper_three_wheel_free").with_run(method=EXACT)
    program = workshop.host_program(Variant(scene, "double", "-O0", True))
    symbols = run_tool(["nm", str(program)]).split()
    assert METHOD_SYMBOLS & set(symbols) == {"laconic_exact_flow"}
    assert not [name for name in symbols if "prepare" in name]


@pytest.mark.nightly
@needs_board
def test_on_a_cortex_m4f_the_bits_are_the_hosts_and_nothing_foreign_is_linked(workshop: Workshop):
    row = board_row(workshop, M4F, Variant(read_scene("s1").with_run(method=EXPLICIT), "single", "-Os", True))
    assert row["same_bits"]
    assert row["double_helpers"] == 0
    assert row["heap"] == 0
    assert row["static_ram"] == 0
    assert 0 < row["instructions"] <= 430
    assert row["stack_measured"] <= row["worst_stack"] + 32  # the caller's own frame is measured, too
    assert row["stack_measured"] <= 176 and row["worst_stack"] <= 208 and row["step_code"] <= 1800


def test_the_command_reports_what_it_wrote_and_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    assert run(["trim", "s1", "--real", "single", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert str(tmp_path / "laconic_scene.h") in printed
    assert printed.endswith("left out: axle torque, body wrench, world force, sampled input, own wheels, slope, "
                            "friction\n")


def test_damping_of_the_motors_is_not_told_as_left_out_on_ground_with_friction(tmp_path: Path, capsys):
    assert run(["trim", "skid_steer", "--out", str(tmp_path)]) == 0
    left_out = capsys.readouterr().out.strip().partition("left out: ")[2].split(", ")
    assert "decay of ideal rolling" in left_out and "damping" not in left_out


@needs_gcc
def test_a_program_of_the_other_scalar_type_does_not_compile_with_the_model(tmp_path: Path):
    trimmed(read_scene("s1"), "single").write(tmp_path)
    include = Path(__file__).resolve().parents[4] / "core_c" / "include"
    command = ["gcc", "-fsyntax-only", f"-I{include}", "-include", "laconic_scene_model.h", "-x", "c", "/dev/null"]
    with pytest.raises(ResultFails, match="was prepared for single: compile with LACONIC_SINGLE"):
        run_tool(command, tmp_path)
    run_tool([*command, "-DLACONIC_SINGLE"], tmp_path)


@pytest.mark.nightly
@needs_board
@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake here")
def test_cmake_builds_the_library_for_a_board_with_another_trees_environment(tmp_path: Path):
    if build_dir() != Path(sys.prefix).parent:
        pytest.skip("the environment belongs to another build tree")
    root = Path(__file__).resolve().parents[4]
    run_tool(["cmake", "-S", str(root), "-B", str(tmp_path), "--toolchain", str(root / "cmake" / "cortex_m.cmake"),
              "-DLACONIC_SCENE=scenes/s1.toml", "-DLACONIC_SCENE_REAL=single", f"-DLACONIC_VENV={sys.prefix}"])
    run_tool(["cmake", "--build", str(tmp_path)])
    assert (tmp_path / "lib" / "liblaconic_scene.a").is_file()


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake here")
def test_cmake_names_the_remedy_for_a_scene_that_is_not_there(tmp_path: Path):
    import subprocess
    root = Path(__file__).resolve().parents[4]
    done = subprocess.run(["cmake", "-S", str(root), "-B", str(tmp_path / "b"), "-DLACONIC_SCENE=scenes/nothing.toml"],
                          capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "no such scene file" in done.stderr


# ---- The core as two files and the files of one scene make a program that needs a C compiler and nothing else.

PROGRAM = """\
#include "laconic_scene_model.h"
#include <stdio.h>

int main(void) {
    laconic_state state = laconic_scene_start;
    laconic_input input = {0};
    laconic_pose pose;
    input.voltage_V[0] = 3;
    for (int i = 0; i < 100; i++)
        if (laconic_step(&laconic_scene_model, &laconic_scene_integrator, &state, &input)) return 1;
    laconic_pose_of(&pose, &laconic_scene_model, &state);
    printf("%.9g %.9g %.9g\\n", (double)pose.x_m, (double)pose.y_m, (double)pose.heading_rad);
    return 0;
}
"""


def test_the_command_writes_the_two_files_into_a_folder_for_programs(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["core"]) == 0
    assert capsys.readouterr().out == "wrote laconic/laconic.h, laconic/laconic.c\n"
    for name in ("laconic.h", "laconic.c"):
        assert (tmp_path / "laconic" / name).read_bytes() == built(f"amalgamation/{name}").read_bytes()


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_commands_of_the_page_make_a_program_for_one_scene_with_the_cores_bits(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (SOURCE_DIR / "docs" / "performance.md").read_text(encoding="utf-8")
    block = re.search(r"```sh\n(laconic core\n.*?)```", page, re.DOTALL)
    assert block is not None
    monkeypatch.chdir(tmp_path)
    Path("program.c").write_text(PROGRAM, encoding="utf-8")
    for line in block[1].replace("\\\n", "").splitlines():
        program, *arguments = shlex.split(line)
        if program == "laconic":
            assert run(arguments) == 0
        else:
            subprocess.run([program, *arguments], check=True)
    printed = subprocess.run(["./program"], check=True, capture_output=True, text=True).stdout
    scene = read_scene("s1").with_run(real="single")
    plant = scene.plant(scene.core())
    plant.run({"voltage_V[1]": 3.0}, 100)
    pose = plant.pose
    assert [np.float32(each) for each in printed.split()] == [pose.x_m, pose.y_m, pose.heading_rad]


# ------------------------------------------------------------------------------- vehicles with hinges

STEPS_OF_TREES = 300
TREE_PROGRAM = """\
#include <stdio.h>
#include <string.h>
#include "laconic_scene_model.h"

static const laconic_articulated_input given = {INPUT};

int main(void) {
    laconic_articulated_state state = laconic_scene_start;
    laconic_articulated_motion now;
    for (int k = 0; k < STEPS; k++)
        if (laconic_articulated_step(&laconic_scene_model, &laconic_scene_integrator, &state, &given, &given, NULL))
            return 1;
    laconic_articulated_motion_of(&now, &laconic_scene_model, &state);
    printf("%a %a %a %a\\n", (double)now.x_m, (double)now.y_m, (double)now.heading_rad, (double)now.energy_J);
    for (int b = 0; b < laconic_scene_model.body_count; b++) printf("%a ", (double)now.hinge_angle_rad[b]);
    for (int i = 0; i < laconic_scene_model.wheel_count; i++) printf("%a ", (double)now.wheel_angle_rad[i]);
    return 0;
}
"""


def tree_sources(scene: Scene, real: str, folder: Path) -> tuple[list[str], list[float]]:
    """Words of a compiler for the trimmed core of a scene with hinges and a program; and what it is to print."""
    trimmed(scene, real).write(folder)
    scene = scene.with_run(real=real)
    vehicle = ArticulatedVehicle.of(scene)
    row = Commands(scene, vehicle, scene.inputs_on_grid()).first_row()
    row[: scene.wheel_count] += 3.0
    plant = start_plant(scene, vehicle, row)
    held = initializer(vehicle.core.ffi, plant._input(row)[0], {})
    text = TREE_PROGRAM.replace("{INPUT}", held).replace("STEPS", str(STEPS_OF_TREES))
    (folder / "main.c").write_text(text, encoding="utf-8")
    plant.run(row, STEPS_OF_TREES)
    now = plant.motion()
    core = SOURCE_DIR / "core_c"
    files = [*sorted((core / "src").glob("*/*.c")), *sorted((core / "optional" / "articulated").glob("*.c"))]
    folders = [core / "include", folder, *{file.parent for file in files}]
    flags = ["-std=c99", "-ffp-contract=off", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
             '-DLACONIC_SCENE_HEADER="laconic_scene.h"', *(["-DLACONIC_SINGLE"] if real == "single" else [])]
    words = [*flags, *(f"-I{each}" for each in folders), *map(str, files), "main.c", "laconic_scene_model.c"]
    return words, [now.x_m, now.y_m, now.heading_rad, now.energy_J, *now.hinge_angle_rad, *now.wheel_angle_rad]


@needs_gcc
@pytest.mark.parametrize(("name", "real"), [("f1tenth", "double"), *(
    pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("frc_swerve_mk4i", "single"), ("mir_like", "double"), ("tricycle_agv", "single"), ("pr2_base", "double"),
        ("tugger_train", "single"),
        ("wheel_loader", "double"), ("wheelchair", "single")))])
def test_a_trimmed_core_with_hinges_gives_the_same_bits_as_the_whole_one(name: str, real: str, tmp_path: Path):
    words, expected = tree_sources(read_scene(name), real, tmp_path)
    run_tool(["gcc", "-O0", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *words, "-o", "trimmed"], tmp_path)
    found = [float.fromhex(word) for word in run_tool([str(tmp_path / "trimmed")]).split()]
    assert found == expected and max(map(abs, found)) > 1e-3
    symbols = run_tool(["nm", "trimmed"], tmp_path)
    assert "laconic_articulated_step" in symbols and "articulated_prepare" not in symbols


def deepest(folder: Path, start: str) -> int:
    """Bytes of stack of the deepest chain of calls, from the graphs that gcc writes."""
    frame, calls = dict[str, int](), dict[str, set[str]]()
    for graph in folder.glob("*.ci"):
        text = graph.read_text(encoding="utf-8")
        local = {title: title.rpartition(":")[2] for title in re.findall(r'title: "([^"]+)"', text)}
        sizes = re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \((?:static|dynamic)', text)
        frame |= {local[title]: int(size) for title, size in sizes}
        for caller, callee in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text):
            calls.setdefault(caller.rpartition(":")[2], set()).add(callee.rpartition(":")[2])
    known: dict[str, int] = {}

    def below(name: str) -> int:
        if name not in known:
            known[name] = 0  # the core has no recursion
            known[name] = frame.get(name, 0) + max((below(each) for each in calls.get(name, ())), default=0)
        return known[name]

    return below(start)


@pytest.mark.nightly
@needs_board
@pytest.mark.parametrize("name", ["mir_like", "f1tenth", "tricycle_agv", "frc_swerve_mk4i", "tugger_train"])
def test_flash_and_stack_of_a_step_with_hinges_on_a_cortex_m4f_are_printed(
        name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A bar for each: the constants of a scene and all four methods, without preparation."""
    words, _ = tree_sources(read_scene(name), "single", tmp_path)
    program = (tmp_path / "main.c").read_text(encoding="utf-8")
    shown = program[: program.index("    laconic_articulated_motion_of")].replace("#include <stdio.h>\n", "")
    (tmp_path / "main.c").write_text(shown.replace("    laconic_articulated_motion now;\n", "") + "    return 0;\n}\n",
                                     encoding="utf-8")
    run_tool([M4F.tool("gcc"), *M4F.flags, "-Os", "-fcallgraph-info=su", *words, "-nostartfiles", "-Wl,-e,main", "-o",
              "board"], tmp_path)
    text, data, bss = map(int, run_tool([M4F.tool("size"), "board"], tmp_path).splitlines()[1].split()[:3])
    stack = deepest(tmp_path, "laconic_articulated_step")
    state = load("single").ffi.sizeof("laconic_articulated_state")
    with capsys.disabled():
        print(f"\n{name}: flash {text + data} bytes with constants, stack of a step {stack} bytes, static RAM {bss} "
              f"bytes; a state of this build with 8 bodies has {state} bytes")
    assert 5_000 < text + data < 60_000 and 500 < stack < 16_000 and data + bss == 0
