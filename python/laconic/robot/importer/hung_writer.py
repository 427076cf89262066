"""The scene of an imported robot that has bodies on hinges."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.importer.dropped import idle_of
from laconic.robot.importer.first_run import SIGNALS
from laconic.robot.importer.hung import ahead_of, hung_of, links_of_carriage
from laconic.robot.importer.hung_push import SHORTEST_S, STEP_S, Plan, drive, shortened
from laconic.robot.importer.hung_scene import HungTables, rigid_table
from laconic.robot.importer.imported_scene import Imported, Writer, _rounded, in_one_line
from laconic.robot.importer.robot_tree import add_up
from laconic.robot.importer.rollers import Kind
from laconic.robot.importer.supports import find_supports
from laconic.robot.importer.wheels import FoundWheel
from laconic.scene import Scene, scene_of
from laconic.scene.standing import Standing, standing_of
from laconic.scene.table import Table

if TYPE_CHECKING:
    from laconic.simulation import Trajectory

IDEAL = ("the ground is ideal, as wheels on hinges do not slip; --no-hinges makes casters and steered wheels supports, "
         "for ground with friction and for commands that do not take hinges")
HELD = ("give --no-hinges for supports in the place of casters and steered wheels, or --wheel JOINT for the wheels "
        "that count")


class HungWriter(Writer):
    """Writes bodies on hinges besides the carriage. The supports are those of the carriage."""

    def begin(self) -> None:
        """Takes what hangs on hinges off the carriage."""
        is_fixed = any(kind.kind == "fixed" for kind in self.kinds)
        self.bodies, self.ground, remarks = hung_of(self.robot, self.ground, is_fixed)
        self.every = replace(self.ground, wheels=(*self.ground.wheels, *(
            wheel for body in self.bodies for wheel in body.wheels)))
        self.supports, untouching = find_supports(self.robot, self.ground, self.bodies)
        self.idle = idle_of(self.every)
        self.carriage = add_up(links_of_carriage(self.robot, self.bodies))
        self.tables = HungTables(self.bodies, self.idle, bool(self.ground.wheels), self.comments, _rounded)
        self.placed = self.tables.placed(self.ground.wheels)
        self.remarks = [*self.robot.remarks, *self.ground.remarks, *remarks, *untouching, *self.doubts(self.every),
                        IDEAL]

    def imported(self) -> Imported:
        """All tables, checked by the core."""
        data: dict[str, Any] = {"name": self.robot.name, "source": f"{self.robot.path.name}, {self.robot.format}",
                                "vehicle": self.vehicle()}
        self.remarks += self.tables.remarks
        if self.answers.friction_coefficient is not None:
            data["vehicle"]["friction_coefficient"] = float(self.answers.friction_coefficient)
            self.comments["vehicle", "friction_coefficient"] = "said with --friction, for the margin to slip"
            self.remarks.append("--friction: wheels on hinges do not slip; the run has the margin to slip instead")
        self.remark_friction()
        scene = self.checked(data | {"run": {"duration_s": SHORTEST_S, "step_s": STEP_S}})
        self.name_joints(data, scene)
        standing = self.standing(scene)
        if standing.tips:
            self.remarks.append(f"the robot: {standing.tips}")
        plan = Plan(self.placed, self.bodies, self.carriage, ahead_of(self.ground))
        driven = drive(plan, data, self.robot.path, _rounded)
        if driven.remark:
            self.remarks.append(driven.remark)
        if driven.inputs:
            data["input"] = driven.inputs
        firsts = [next((i for i, each in enumerate(driven.inputs) if each["signal"].startswith(start)), None)
                  for start in ("axle", "steering")]
        for at, words in zip([each for each in firsts if each is not None], driven.words, strict=False):
            self.comments["input", str(at), "signal"] = f"assumption: {words}"
        data["run"] = {"duration_s": driven.duration_s, "step_s": STEP_S}
        run = self.check_run(data)
        self.promise = driven.promise
        self.judge(self.checked(data), run)
        return self.written(data, standing, self.tables.words())

    def name_joints(self, data: dict[str, Any], scene: Scene) -> None:
        """`[base] joint_names`: wheels, and hinges too where each has sense and zero of its joint."""
        names = [in_one_line(each.wheel.name) for each in self.placed]
        bodies = [self.tables.by_name[hinge.name] for hinge in scene.hinges]
        if all(body.sense > 0.0 and abs(body.zero_rad) < 1e-9 for body in bodies):
            names += [in_one_line(body.joint.name) for body in bodies]
        if all(names) and len(set(names)) == len(names):
            data["base"] = {"joint_names": names}
            self.comments["base", "joint_names"] = "for laconic ros2"

    def motors(self) -> list[str]:
        """The driven wheels, on hinges too."""
        return [each.wheel.name for each in self.placed if each.is_driven]

    def vehicle(self) -> dict[str, Any]:
        """`[vehicle]` is the carriage alone; then wheels, bodies, supports."""
        wheels = [self.wheel(i, w, k) for i, (w, k) in enumerate(zip(self.ground.wheels, self.kinds, strict=True))]
        for wheel, body in self.tables.extra_wheels():
            where = ("vehicle", "wheel", str(len(wheels)))
            table = self.wheel(len(wheels), wheel, Kind("fixed", None, ""))
            self.comments.pop((*where, "x_m"), None)
            wheels.append(self.tables.wheel(table, wheel, body, where))
        vehicle = self.totals() | self.of_all(wheels)
        if wheels:
            vehicle["wheel"] = wheels
        vehicle |= self.tables.tables()
        if self.supports:
            vehicle["support"] = [self.support(i, each) for i, each in enumerate(self.supports)]
        return vehicle

    def of_all(self, wheels: list[dict[str, Any]]) -> dict[str, float]:
        """What the wheels share; a wheel without a motor has no damping of its own."""
        if not wheels:
            first = self.every.wheels[0]
            return {"wheel_radius_m": _rounded(first.radius_m), "wheel_inertia_kgm2": _rounded(first.inertia_kgm2)}
        found = self.shared(wheels)
        for table in wheels:
            if table.get("driven") is False:
                table.pop("motor_damping_Nms", None)
        return found

    def totals(self) -> dict[str, Any]:
        """Those of the carriage: body 0 without what hangs on hinges."""
        super().totals()  # which checks the whole
        own = self.carriage
        if own.mass_kg <= 0.0:
            raise BadInput(f"{self.robot.path}: all mass hangs on hinges, and the base {self.robot.base} has none; "
                           f"give its link an <inertial>; or {HELD}")
        yaw = float(own.inertia_kgm2[2, 2])
        if yaw <= 0.0:
            raise BadInput(f"{self.robot.path}: the yaw inertia of the base without what hangs on hinges is {yaw:g} "
                           "kg·m²; give its links' <inertia>")
        count = sum(link.mass_kg > 0.0 for link in links_of_carriage(self.robot, self.bodies))
        without = "without what hangs on hinges"
        of_which = f"sum of {count} links" if count > 1 else "of one link"
        self.comments["vehicle", "mass_kg"] = f"{of_which}, {without}"
        self.comments["vehicle", "yaw_inertia_kgm2"] = "of these links about their common centre of mass"
        return {"mass_kg": _rounded(own.mass_kg), "yaw_inertia_kgm2": _rounded(yaw), "com_x_m": _rounded(own.com_m[0]),
                "com_y_m": _rounded(own.com_m[1]),
                "com_z_m": _rounded(max(float(own.com_m[2]) - self.ground.height_m, 0.0))}

    def needs_inertia(self, wheel: FoundWheel) -> bool:
        """Those that hang on hinges and only roll may have none."""
        body = next((each for each in self.bodies if wheel in each.wheels), None)
        return body is None or self.tables.is_driven(wheel, body)

    def checked(self, data: dict[str, Any]) -> Scene:
        """The scene that the tables make, at its start; what the core refuses is BadInput, by the robot's file."""
        try:
            scene = scene_of(Table(self.robot.path, "", copy.deepcopy(data)))
            scene.articulated_vehicle(scene.core())
        except (Refused, BadInput) as refused:
            raise BadInput(f"{str(refused).rstrip('.')}; {HELD}") from None
        return scene

    def check_run(self, data: dict[str, Any]) -> Trajectory | None:
        """The first run. Ends it before a step that is refused, such as where a caster comes to its stop; then None."""
        from laconic.simulation import RunRefused, simulate

        scene = self.checked(data)
        try:
            return simulate(scene, SIGNALS)
        except RunRefused as refused:
            ends_s = round(float(np.floor(10.0 * refused.run.time_s[-1])) / 10.0, 6)
            if ends_s < STEP_S:
                raise BadInput(f"{str(refused).rstrip('.')}; {HELD}") from None
            self.remarks.append(f"the run ends before this: {str(refused).removeprefix(f'{self.robot.path}: ')}")
            data["run"]["duration_s"] = ends_s
            data["input"] = shortened(data.get("input", []), ends_s)
            self.checked(data)
            return None
        except (Refused, BadInput) as refused:
            raise BadInput(f"{str(refused).rstrip('.')}; {HELD}") from None

    def standing(self, scene: Scene) -> Standing:
        """Loads at rest as the file places all parts, held as one body."""
        rigid = rigid_table(scene.vehicle, self.placed, self.whole.mass_kg, self.whole.com_m)
        return standing_of(replace(scene, vehicle=rigid, hinges=()))

    def words(self) -> list[str]:
        """A line for each wheel, in the order of the signals."""
        found = super().words()
        for each in self.placed[len(found):]:
            body = each.body
            assert body is not None  # as they follow those of the carriage
            x, y = each.wheel.hub_m[:2]
            drives = ", driven" if each.is_driven else ""
            found.append(f"wheel {len(found) + 1}: {each.wheel.name}, on hinge {body.name}{drives}, radius "
                         f"{each.wheel.radius_m:.4g} m at ({x:.4g}, {y:.4g}) m")
        return found
