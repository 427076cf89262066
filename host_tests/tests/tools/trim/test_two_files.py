"""The core as two files and the files of one scene make a program that needs a C compiler and nothing else."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR, built
from laconic.cli.main import run
from laconic.scene import read_scene

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
