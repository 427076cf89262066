"""A smoke test for each part of host_tests/assurance: it runs, passes the product, and finds a planted fault."""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest
from mpmath import mp, mpf

from assurance import (
    common,
    faults,
    fuzz,
    linked,
    misra,
    mujoco_trees,
    mutate,
    population,
    proof,
    run,
    sizes,
    targets,
    tidy,
)
from assurance.fuzz import files
from assurance.long import RUNS, drift
from laconic.core import load
from laconic.errors import BadInput, ResultFails


def part(*words: str) -> int:
    """The status of the entry script."""
    return run.main([*words])


def needs(*tools: str) -> pytest.MarkDecorator:
    missing = [tool for tool in tools if shutil.which(tool) is None]
    return pytest.mark.skipif(bool(missing), reason=f"no {missing}")


def test_the_entry_script_lists_its_parts_and_refuses_others(capsys: pytest.CaptureFixture[str]) -> None:
    script = common.ROOT / "host_tests/assurance/run.py"
    done = subprocess.run([sys.executable, script, "--help"], capture_output=True, text=True, check=True)
    assert all(f"\n    {name}" in done.stdout for name in run.PARTS)
    assert part("fuzz", "--only", "nothing") == 2
    assert "known are slcan" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        part("nothing")


TEXT = """/* A file. */
#define TWICE(x) ((x) * 2)
static const int table[2] = {1, 2};
static int bounded(int x, int most) {
    const int sum = x + table[0];
    if (x < most && sum != 3) return sum;
    for (int k = 0; k < 2; k++) x += bounded(k, x);
    return TWICE(x);
}
"""


def test_a_mutant_is_the_text_with_one_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutate, "ROOT", tmp_path)
    (tmp_path / "text.c").write_text(TEXT)
    found = {f"{each.where.partition(':')[2]} {each.edit[3]}": "".join(each.alone(TEXT).split())
             for each in mutate.mutants_of("text.c")}
    assert found["6:11 relational < to <="] == "".join(TEXT.replace("x < most", "x <= most").split())
    assert found["7:46 swapped arguments"] == "".join(TEXT.replace("bounded(k, x)", "bounded(x, k)").split())
    assert {"2:23 arithmetic * to /", "3:30 constant 1 to 2", "5:23 dropped + term", "6:9 negated condition",
            "7:33 dropped statement", "7:35 arithmetic += to -="} <= found.keys()
    assert not any(where.startswith("4:") for where in found)


@needs("gcc", "ctest")
@pytest.mark.parametrize("name, program, sample", [
    ("cmac.c", "secure", 2), pytest.param("noise.c", "noise", 12, marks=pytest.mark.nightly)])
def test_mutants_of_a_small_file_are_noticed_behind_switches_and_alone(capsys: pytest.CaptureFixture[str], name: str,
                                                                       program: str, sample: int) -> None:
    file = next(path for path in mutate.sources(None) if path.endswith(f"/{name}"))
    if not any(program in path.name for path in linked.programs()):
        pytest.skip("the C tests of this file are not built")
    assert mutate.run(argparse.Namespace(only=file, sample=sample, seed=1, minutes=9.0, least=50.0))
    assert f"{sample} mutants" in capsys.readouterr().out


@needs("gcc")
@pytest.mark.parametrize("name", ["slcan", pytest.param("bus", marks=pytest.mark.nightly)])
def test_a_fuzz_target_runs_its_seeds_and_goes_on_from_them(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert fuzz.search(name, 0.0, 3000, 1)
    assert "nothing found" in capsys.readouterr().out


@pytest.mark.parametrize("name, count", [("scenes", 25), ("column maps", 60), ("DBC maps", 30), ("DBC", 12)])
def test_spoilt_files_are_read_or_refused_by_one_line(name: str, count: int) -> None:
    done, lines, complaint, _ = files.spoil(files.READERS[name], 1, common.Clock(9.0), count)
    assert not complaint
    assert done == count and lines > 100


@pytest.mark.parametrize("error, said", [(ZeroDivisionError("1/0"), "ZeroDivisionError"),
                                         (BadInput("spoilt.toml: is wrong"), "states no remedy"),
                                         (BadInput("is wrong; give another"), "does not name the file")])
def test_what_is_no_refusal_by_one_line_is_found(error: Exception, said: str, tmp_path: Path) -> None:
    def use(_: Path) -> None:
        raise error

    (tmp_path / "good.toml").write_text('name = "a"\n')
    reader = files.Reader([tmp_path / "good.toml"], use)
    assert said in files.spoil(reader, 1, common.Clock(9.0), 3)[2]


@pytest.mark.nightly
@needs("gcc")
def test_no_flipped_bit_of_a_node_with_all_checks_changes_its_motion_unnoticed(
        capsys: pytest.CaptureFixture[str]) -> None:
    assert faults.memory(400, 1, ("double",), ("all",))
    assert "double, checks all: 400 of" in capsys.readouterr().out


@pytest.mark.nightly
@needs("gcc")
def test_lost_power_moves_nothing_unasked() -> None:
    assert faults.session("power", ("single",))


@pytest.mark.nightly
@needs("cppcheck")
def test_misra_has_no_violation_without_a_deviation_and_finds_one(tmp_path: Path) -> None:
    assert misra.run(argparse.Namespace(only=["firmware_stub/wire/crc.c"]))
    (tmp_path / "wrong.c").write_text("#include <stdio.h>\nint f(int a) { goto out; out: return a; }\n")
    assert any("misra-c2012-21.6" in line for line in misra.findings([tmp_path / "wrong.c"], []))


@pytest.mark.nightly
@needs("clang-tidy")
def test_clang_tidy_finds_nothing() -> None:
    assert tidy.run(argparse.Namespace(only=["firmware_stub/wire/crc.c"]))


@pytest.mark.nightly
@needs("frama-c")
def test_the_analyser_excludes_undefined_behaviour_of_an_entry_and_finds_it_in_another(tmp_path: Path) -> None:
    crc = next((common.ROOT / "firmware_stub").rglob("crc.c"))
    include = f"-I{common.ROOT / 'firmware_stub/include'}"
    (tmp_path / "right.c").write_text('#include "laconic_node/crc.h"\nstatic uint8_t data[4];\n'
                                      "void prove_right(void) { (void)laconic_crc32(0, data, sizeof data); }\n")
    assert proof.alarms([crc, tmp_path / "right.c"], [include], "prove_right") == []
    (tmp_path / "wrong.c").write_text("int a[2];\nvoid prove_wrong(void) { for (int n = 0; n < 3; n++) a[n] = 1; }\n")
    assert [what for _, what in proof.alarms([tmp_path / "wrong.c"], [], "prove_wrong")] == [
        "accessing out of bounds index"]


@pytest.mark.nightly
@needs("gcc")
def test_this_machines_compiler_gives_trajectories_a_hash(tmp_path: Path) -> None:
    hashes, wrong = targets.TARGETS[0].bits(tmp_path, "double", 16)
    assert hashes and not wrong


@pytest.mark.parametrize("number", [0, 5])
def test_auto_is_near_the_true_motion_of_made_up_vehicles(number: int) -> None:
    rows = population.rows_of(population.made(1, number, 6), ("auto",))
    assert all(population.worst_of(row) <= 1e-8 for row in rows)
    assert {row["truth"] for row in rows} == {"enclosure" if number == 0 else "50 digits"}


def test_a_wrong_sign_in_the_50_digits_lies_outside_of_the_enclosure(monkeypatch: pytest.MonkeyPatch) -> None:
    from laconic.tools.report import collocation

    right = collocation.rate_at
    monkeypatch.setattr(collocation, "rate_at", lambda *given: [-x for x in right(*given)])
    vehicle = population.made(1, 0, 6)
    with pytest.raises(ResultFails, match="outside of its enclosure"):
        population.truth_of(vehicle, vehicle.plant(load("double"), "auto", 0.001).nu)


@pytest.mark.nightly
@pytest.mark.parametrize("case", [case for case in drift.CASES if case.nu[2]], ids=lambda case: case.name)
def test_the_closed_form_is_the_motion_that_collocation_gives(case: drift.Case) -> None:
    with drift.digits():
        each = drift.prepared(case, float)
        time_s = mpf("7.3") if case.steady else each.motion.period_s * mpf("1.37")
        truth = each.motion.at(Fraction(mp.nstr(time_s, 50)))
        nu, shift, turned = drift.along(each.motion.model, each.motion.nu, each.held, mpf(mp.nstr(time_s, 50)))
        place = each.motion.place + shift * mp.expj(each.motion.heading)
        assert abs(place - truth.place) < mpf("1e-22")
        assert abs(each.motion.heading + turned - truth.heading) < mpf("1e-22")
        assert max(abs(p - q) for p, q in zip(nu, truth.nu, strict=True)) < mpf("1e-22")


@pytest.mark.nightly
def test_heading_and_place_do_not_drift_and_a_millionth_too_slow_is_found() -> None:
    one = drift.Run("auto", "double")
    one.run(20_000)
    rows = one.rows()
    assert {row["case"] for row in rows} == {case.name for case in drift.CASES}
    assert not any(drift.drifted(row, "double") for row in rows)
    spin = next(row for row in rows if row["case"] == "spin, free")
    assert drift.drifted(spin | {"heading_relative": 1e-6}, "double")


@pytest.mark.parametrize(("name", "usual_mm"), [("mir_like", 4.0), ("frc_swerve_mk4i", 50.0)])
def test_contacts_of_mujoco_that_settle_fast_end_where_this_core_does(name: str, usual_mm: float) -> None:
    pytest.importorskip("mujoco", reason="mujoco is not installed")
    changes = {key: mujoco_trees.CHANGES[key] for key in ("usual", "solref 0.002")}
    found = mujoco_trees.compared(name, changes, rounds=1)
    assert found["usual"].off_mm > usual_mm
    assert max(found["solref 0.002"].off_mm, found[mujoco_trees.CORE].off_mm) < 0.12 * usual_mm
    assert abs(mujoco_trees.creep_mm(name, None, 1.0)) < 1e-9 < mujoco_trees.creep_mm(name, mujoco_trees.USUAL, 1.0)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["batch", "derivatives", "friction", "rig", "soft_double"])
def test_a_long_run_takes_its_least_piece_and_finds_nothing(name: str) -> None:
    assert name in RUNS and part("long", name, "--minutes", "0") == 0


def test_sizes_tell_product_tests_and_apparatus_apart() -> None:
    kinds = {"core_c/src/state/plant.c": "product", "core_c/tests/state/test_plant.c": "test", ".ci/run": "apparatus",
             "host_tests/assurance/sizes.py": "apparatus", "python/laconic/core/plant.py": "product"}
    assert {path: sizes.kind_of(path) for path in kinds} == kinds
    assert sizes.lines_by_kind(["host_tests/assurance/sizes.py"])["apparatus"] > 20
