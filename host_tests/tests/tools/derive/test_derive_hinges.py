"""Equations of vehicles with hinges: by the laconic equations, against Maggi's, the core, and as compiled C."""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from cffi import FFI

from laconic import Scene, build_scene, read_scene
from laconic.base.paths import scene_names, scene_path
from laconic.cli.main import run
from laconic.core import load
from laconic.core.articulated import ArticulatedVehicle
from laconic.scene.hinges import file_has_hinges
from laconic.tools.derive.printing import c_name
from laconic.tools.derive.scene_check import RandomMoments, tree_core_difference, tree_forms_difference
from laconic.tools.derive.tree_printing import tree_c, tree_latex, tree_text
from laconic.tools.derive.tree_system import Tree, derive_tree, energy_of_twists, tree_numbers

HINGED = [name for name in scene_names()
          if file_has_hinges(scene_path(name)) and not read_scene(name).slips_on_hinges]
QUICK = ("f1tenth", "tricycle_agv", "wheel_loader")
EVERY, EVERY_AND_WHEELCHAIR = ([name if name in by_day else pytest.param(name, marks=pytest.mark.nightly)
                               for name in (*HINGED, "on a slope")] for by_day in (QUICK, (*QUICK, "wheelchair")))
SIDE = {"kind": "fixed", "axle_deg": -90.0, "x_m": 0.0}


def on_a_slope() -> Scene:
    """An offset caster and a sprung two-axle trailer behind a trailer, on a slope; an omni carriage."""
    omni = [{"kind": "roller", "x_m": x, "y_m": y, "axle_deg": axle, "roller_deg": 50.0}
            for x, y, axle in ((0.3, 0.1, 10.0), (-0.2, 0.3, 130.0), (-0.2, -0.3, 250.0))]
    return build_scene({
        "name": "On a slope", "run": {"duration_s": 1.0, "step_s": 0.01},
        "ground": {"slope_deg": 4.0, "slope_heading_deg": 30.0},
        "vehicle": {"mass_kg": 20.0, "yaw_inertia_kgm2": 0.8, "com_x_m": 0.05, "com_y_m": -0.02,
                    "wheel_radius_m": 0.08, "wheel_inertia_kgm2": 0.01, "motor_gain_Nm_per_V": 0.5,
                    "motor_damping_Nms": 0.4,
                    "payload": {"mass_kg": 3.0, "yaw_inertia_kgm2": 0.1, "x_m": 0.1, "y_m": 0.1},
                    "wheel": [
                        *omni, {**SIDE, "x_m": -0.4, "y_m": 0.1, "body": "second"},
                        {**SIDE, "x_m": -0.1, "y_m": 0.2, "body": "second"}],
                    "caster": [{"x_m": 0.3, "y_m": 0.0, "trail_m": 0.05, "offset_m": 0.01, "radius_m": 0.04,
                                "mass_kg": 0.7, "yaw_inertia_kgm2": 0.002, "damping_Nms": 0.01}],
                    "trailer": [{"name": "first", "hitch_x_m": -0.3, "length_m": 0.5, "track_m": 0.3,
                                 "radius_m": 0.05, "mass_kg": 5.0, "yaw_inertia_kgm2": 0.1}],
                    "body": [{"name": "second", "parent": "first", "hinge": "free", "hinge_x_m": -0.6, "mass_kg": 2.0,
                              "hinge_y_m": 0.02, "yaw_inertia_kgm2": 0.03, "stiffness_Nm": 0.4, "rest_deg": 5.0},
                             {"name": "mast", "hinge": "motor", "hinge_x_m": 0.1, "mass_kg": 1.0, "com_x_m": 0.2,
                              "yaw_inertia_kgm2": 0.02, "gain_Nm_per_V": 0.3, "damping_Nms": 0.2}]}})


@cache
def derived(name: str) -> tuple[Tree, ArticulatedVehicle]:
    scene = on_a_slope() if name == "on a slope" else read_scene(name)
    vehicle = scene.articulated_vehicle(load("double"))
    return derive_tree(tree_numbers(scene, vehicle)), vehicle


def test_there_are_eight_scenes_with_hinges() -> None:
    assert len(HINGED) >= 8


@pytest.mark.parametrize("name", EVERY_AND_WHEELCHAIR)
def test_derived_equations_of_a_tree_give_the_cores_accelerations(name: str) -> None:
    assert tree_core_difference(*derived(name), count=40) < 1e-11


@pytest.mark.parametrize("name", [pytest.param("wheelchair", marks=pytest.mark.nightly), *QUICK])
def test_laconic_equations_of_a_tree_are_maggis(name: str) -> None:
    tree, _ = derived(name)
    commanded = name in ("wheel_loader", "f1tenth")
    assert tree.form == ("(2.3)" if commanded else "(2.4)") and tree_forms_difference(tree) < 1e-13


def test_both_checks_notice_a_wrong_equation() -> None:
    tree, vehicle = derived("tricycle_agv")
    wrong = replace(tree, push=tree.push + sp.Matrix([0, sp.Symbol("u_0", real=True), 0]))
    assert tree_forms_difference(wrong) > 1e-3 and tree_core_difference(wrong, vehicle, count=5) > 1e-6


@pytest.mark.parametrize("name", ["wheel_loader", *(
    pytest.param(name, marks=pytest.mark.nightly) for name in ("tugger_train", "pr2_base"))])
def test_the_printed_energy_of_the_twists_is_the_lagrangian_on_the_motions(name: str) -> None:
    tree, _ = derived(name)
    pair = [tree.lagrangian, energy_of_twists(tree.numbers, tree.twists)]
    symbols = sorted(set().union(*(each.free_symbols for each in pair)), key=str)
    evaluate, rng = sp.lambdify(symbols, pair, "numpy", cse=True), np.random.default_rng(4)
    for _ in range(20):
        first, second = evaluate(*rng.uniform(-1.5, 1.5, len(symbols)))
        assert first == pytest.approx(second, rel=1e-12)


def compiled(tree: Tree, folder: Path) -> tuple[FFI, Any, Any]:
    """The two printed functions."""
    source, library = folder / "derived.c", folder / "derived.so"
    source.write_text(tree_c(tree), encoding="utf-8")
    subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC", "-o", library,
                    source, "-lm"], check=True)
    name, ffi, row = c_name(tree.numbers.name), FFI(), "const double *, "
    ffi.cdef(f"void laconic_{name}_rates({row * 2}double, {row * 11}double *);"
             f"void laconic_{name}_motion({row * 5}double *, double *, double *);")
    linked = ffi.dlopen(str(library))
    return ffi, getattr(linked, f"laconic_{name}_rates"), getattr(linked, f"laconic_{name}_motion")


@pytest.mark.parametrize("name", EVERY)
def test_printed_c_of_a_tree_compiles_and_gives_the_cores_motion(name: str, tmp_path: Path) -> None:
    tree, vehicle = derived(name)
    ffi, rates, motion = compiled(tree, tmp_path)
    moments = RandomMoments(tree.numbers, vehicle, seed=11)
    for _ in range(30):
        _, eta, expected = moments.next()
        given = moments.signals
        wrench = [*given["body_force_N"], given["body_moment_Nm"]]
        out = ffi.new("double[]", len(eta))
        rates(list(eta), list(given["psi"]), given["heading_rad"], *(list(given[key]) for key in (
            "voltage_V", "axle_torque_Nm", "hinge_voltage_V", "hinge_torque_Nm", "steering_rate_rad_per_s",
            "hinge_acceleration_rad_per_s2", "steering_twist", "twist_rate")), wrench,
            list(given["world_force_N"]), list(given["world_force_point_m"]), out)
        assert np.abs(np.array(list(out)) - expected).max() <= 1e-11 * max(1.0, np.abs(expected).max())
        twist, turn = ffi.new("double[3]"), ffi.new("double[]", vehicle.body_count)
        spin = ffi.new("double[]", vehicle.wheel_count)
        motion(list(eta), list(given["psi"]), list(given["steering_rate_rad_per_s"]), list(given["steering_twist"]),
               list(given["twist_rate"]), twist, turn, spin)
        there = moments.motion
        found = [*twist, *turn, *spin]
        wanted = [*there.velocity_m_per_s, there.yaw_rate_rad_per_s, *there.hinge_rate_rad_per_s,
                  *there.wheel_speed_rad_per_s]
        assert np.abs(np.array(found) - wanted).max() <= 1e-11 * max(1.0, np.abs(wanted).max())


def test_text_and_latex_of_a_tree_name_bodies_and_numbers_and_have_no_bare_primes() -> None:
    tree, _ = derived("tricycle_agv")
    text, latex = tree_text(tree), tree_latex(tree)
    assert "body 1: front, on carriage; turns by itself" in text and "kappa_1" in text and "  m_0 = 450" in text
    assert r"\dot{\omega}_{1}" in latex and r"h_{\xi 1}" in latex
    assert not any("'" in line for line in latex.splitlines() if not line.startswith("%"))


@pytest.mark.parametrize(("words", "start"), [
    (["--latex"], "% F1TENTH car: laconic equations (2.3)"),
    *(pytest.param(words, start, marks=pytest.mark.nightly)
      for words, start in (([], "F1TENTH car: laconic"), (["--c"], "/* F1TENTH car")))])
def test_derive_prints_a_scene_with_hinges_and_its_checks(words: list[str], start: str,
                                                          capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["derive", "f1tenth", *words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["text"].startswith(start) and len(found["checks"]) == 2
    assert all(value < 1e-12 for value in found["checks"].values())
