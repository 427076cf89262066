"""The equations of motion, by the paper's method."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console

from laconic.base.outputs import STDOUT, check_ending, write_text
from laconic.cli.options import OutputFile, SceneName, only_one
from laconic.errors import BadInput, ResultFails

if TYPE_CHECKING:
    from laconic.scene import Scene
    from laconic.tools.derive.scene_system import VehicleNumbers

EXAMPLES = ("caster", "carriage", "differential-drive", "trailer")
ENDINGS = {"": (".txt", ".md"), "latex": (".tex",), "c": (".c", ".h"), "json": (".json",)}
ALL_ENDINGS = tuple(ending for endings in ENDINGS.values() for ending in endings)
AGREEMENT = 1e-12  # between the forms, and with the core, relative, at random numbers


@click.command("derive")
@click.argument("scene", type=SceneName(hinges=True), required=False)
@click.option("--example", type=click.Choice(EXAMPLES), help="A worked system in symbols, instead of a scene.")
@click.option("--latex", is_flag=True, help="Print LaTeX.")
@click.option("--c", "in_c", is_flag=True, help="Print a C function of the scene's own numbers.")
@click.option("-o", "--out", type=OutputFile(*ALL_ENDINGS, stdout=True), help="Write to a file, not to stdout.")
@click.option("--json", "as_json", is_flag=True, help="Machine-readable: the text and the check.")
def command(scene: str | None, example: str | None, latex: bool, in_c: bool, out: Path | None, as_json: bool) -> None:
    """Derives the equations of motion by the laconic equations (2.4).

    Vehicles with hinges that a command turns have (2.3). The result is checked against the other forms and Maggi's
    equations (1.2) at random numbers, and a scene's also against the C core's derivative.
    """
    given = [name for name in (scene, example) if name is not None]
    if len(given) != 1:
        raise BadInput("derive: give either a SCENE or --example; see laconic derive --help")
    form = (only_one({"--latex": latex, "--c": in_c}) or "").removeprefix("--")
    if example is not None and in_c:
        raise BadInput("--c: needs a scene, whose numbers it writes down; give a SCENE instead of --example")
    check_ending("--out", out or STDOUT, ENDINGS["json" if as_json else form])
    with Console(stderr=True).status("deriving"):
        text, checks = (_of_example if example else _of_scene)(given[0], form)
    text = json.dumps({"text": text, "checks": checks}, indent=2) + "\n" if as_json else text
    write_text(out or STDOUT, text)
    for name, value in checks.items():
        click.echo(f"{name}: {value:.1e}", err=True)
        if not value <= AGREEMENT:
            raise ResultFails(f"{name} is {value:.1e}, above {AGREEMENT:.0e}: the derivation contradicts itself")


def _of_example(name: str, form: str) -> tuple[str, dict[str, float]]:
    from laconic.tools.derive import printing, vehicles
    from laconic.tools.derive.brackets import bracketed
    from laconic.tools.derive.scene_check import forms_difference

    systems = {
        "caster": vehicles.caster,
        "carriage": lambda: vehicles.carriage(vehicles.three_wheel_rows()),
        "differential-drive": vehicles.differential_drive_from_scratch,
        "trailer": vehicles.tractor_with_trailer,
    }
    system = systems[name]()
    result = vehicles.differential_drive() if name == "differential-drive" else bracketed(system)
    checks = {"(2.3), (2.4) and (1.2) differ at most by": forms_difference(system)}
    return printing.as_latex(result) if form == "latex" else printing.as_text(result), checks


def _of_scene(given: str, form: str) -> tuple[str, dict[str, float]]:
    from laconic.scene import read_scene
    from laconic.scene.ground import check_ideal_ground, check_rolling
    from laconic.tools.analyse.from_core import subject_of
    from laconic.tools.derive import printing
    from laconic.tools.derive.scene_check import core_difference, forms_difference
    from laconic.tools.derive.scene_system import carriage_of, derive

    scene = read_scene(given)
    if scene.has_hinges:
        check_rolling(scene, "derive")
        return _of_tree(scene, form)
    check_ideal_ground(scene, "derive")
    subject = subject_of(scene)
    numbers = subject.numbers()
    system = derive(numbers)
    writers = {"latex": printing.as_latex, "c": lambda s: printing.as_c(numbers, s), "": printing.as_text}
    text = writers[form](system)
    if not form:
        text += "\n" + _numbers_text(numbers)
    checks = {"(2.3), (2.4) and (1.2) differ at most by": forms_difference(carriage_of(numbers))}
    checks["derived equations and the C core's derivative differ at most by"] = core_difference(subject, system)
    return text, checks


def _of_tree(scene: Scene, form: str) -> tuple[str, dict[str, float]]:
    from laconic.core import load
    from laconic.tools.derive import tree_printing
    from laconic.tools.derive.scene_check import tree_core_difference, tree_forms_difference
    from laconic.tools.derive.tree_system import derive_tree, tree_numbers

    vehicle = scene.articulated_vehicle(load("double"))
    tree = derive_tree(tree_numbers(scene, vehicle))
    writers = {"latex": tree_printing.tree_latex, "c": tree_printing.tree_c, "": tree_printing.tree_text}
    checks = {f"{tree.form} and Maggi's (1.2) differ at most by": tree_forms_difference(tree),
              "derived equations and the C core's derivative differ at most by": tree_core_difference(tree, vehicle)}
    return writers[form](tree), checks


def _numbers_text(numbers: VehicleNumbers) -> str:
    """The scene's numbers for the symbols above."""
    values = numbers.symbol_values()
    shown = {str(s): float(v) for s, v in values.items()}
    lines = [f"  {name} = {value:.9g}" for name, value in shown.items()]
    motors = list(zip(numbers.motor_gain_Nm_per_V, numbers.motor_damping_Nms, strict=True))
    if len(set(motors)) > 1:
        lines.append("  M_i = c1_i U_i - c2_i chi_i' + T_i,")
        lines += [f"  c1_{i} = {gain:.9g} N m/V,  c2_{i} = {damping:.9g} N m s"
                  for i, (gain, damping) in enumerate(motors, start=1)]
    else:
        gain, damping = motors[0] if motors else (0.0, 0.0)
        lines.append(f"  M_i = c1 U_i - c2 chi_i' + T_i,  c1 = {gain:.9g} N m/V,  c2 = {damping:.9g} N m s")
    return f"with, for {numbers.name},\n" + "\n".join(lines) + "\n"
