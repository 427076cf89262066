"""The convex problem of one step of a vehicle with hinges on ground with friction, dense and in plain coordinates.

It is built from Jacobians body by body and shares no formula with the core, which works in coordinates of unit energy
along the paths of the tree. Unknowns are z = (velocity of the carriage's centre of mass, yaw rate, hinge rates) and the
wheels' speeds s. `residual` judges a step; `solved` finds the step by the conic solver Clarabel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from tree_runner import Case, State, Vector

INFINITE = float("inf")


def rotation(angle: float) -> Vector:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


@dataclass
class Element:
    """x − target = compliance q + normal cone of [low, high], x = row·(z, s); `q`: as the core found it."""

    row: Vector
    low: float
    high: float
    compliance: float = 0.0
    target: float = 0.0
    q: float = 0.0


class Tree:
    """Places and Jacobians of all bodies at the given hinge angles, axes of body 0."""

    def __init__(self, vehicle: Case, psi: Vector) -> None:
        self.bodies = vehicle["bodies"]
        self.n = 3 + len(psi)
        self.angle, self.hinge = [0.0], [np.zeros(2)]
        self.above: list[list[int]] = [[]]
        for j, body in enumerate(self.bodies[1:], start=1):
            parent = body["parent"]
            self.angle.append(self.angle[parent] + psi[j - 1])
            self.hinge.append(self.hinge[parent]
                              + rotation(self.angle[parent]) @ np.array(body["hinge_at_parent_m"]))
            self.above.append([*self.above[parent], j])

    def at(self, body: int, point: list[float]) -> Vector:
        return self.hinge[body] + rotation(self.angle[body]) @ np.array(point)

    def jacobian(self, body: int, point: Vector) -> Vector:
        out = np.zeros((2, self.n))
        out[:, :2] = np.eye(2)
        out[:, 2] = [-point[1], point[0]]
        for j in self.above[body]:
            x, y = point - self.hinge[j]
            out[:, 2 + j] = [-y, x]
        return out

    def turning(self, body: int) -> Vector:
        out = np.zeros(self.n)
        out[2] = 1
        out[[2 + j for j in self.above[body]]] = 1
        return out


class Problem:
    """The step of size h from a state under a segment's inputs."""

    def __init__(self, vehicle: Case, before: State, segment: Case, h: float, loads: Vector | None = None) -> None:
        self.h, self.wheels, hinges = h, vehicle["wheels"], len(vehicle["bodies"]) - 1
        ahead = before.psi + 0.5 * h * before.z[3:]
        self.tree = Tree(vehicle, ahead)
        self.n, self.count = 3 + hinges, len(self.wheels)
        self.mass, self.push = np.zeros((self.n, self.n)), np.zeros(self.n)
        back = rotation(-h * before.z[2])
        for b, body in enumerate(vehicle["bodies"]):
            place = self.tree.at(b, body["com_m"])
            jacobian, turning = self.tree.jacobian(b, place), self.tree.turning(b)
            velocity = back @ before.velocity[b][:2]
            self.mass += body["mass_kg"] * jacobian.T @ jacobian + body["yaw_inertia_kgm2"] * np.outer(turning, turning)
            self.push += (body["mass_kg"] * jacobian.T @ velocity
                          + body["yaw_inertia_kgm2"] * turning * before.velocity[b][2])
        self.pure_mass, self.carried = self.mass.copy(), self.push.copy()
        self.push[:3] += h * np.array(segment.get("body_wrench", [0, 0, 0]))
        self.elements: list[Element] = []
        for j, body in enumerate(vehicle["bodies"][1:], start=1):
            self._add_hinge(body, j, ahead[j - 1], segment)
        self.loads = np.array([wheel["normal_load_N"] for wheel in self.wheels]) if loads is None else loads
        self._add_wheels(before, segment)

    def unit(self, index: int) -> Vector:
        out = np.zeros(self.n + self.count)
        out[index] = 1
        return out

    def _add_hinge(self, body: Case, j: int, ahead: float, segment: Case) -> None:
        h, row, k = self.h, self.unit(2 + j), 2 + j
        hinges = range(len(segment.get("servo_angle_rad", [])))
        target = segment.get("servo_angle_rad", [0] * 99)[j - 1] if j - 1 in hinges else 0.0
        rate = segment.get("hinge_rate", [0] * 99)[j - 1]
        self.mass[k, k] += h * body["hinge_viscous_Nms"] + h * h * body["spring_Nm_per_rad"]
        self.push[k] += h * (body["spring_Nm_per_rad"] * (body["spring_rest_rad"] - ahead)
                             + segment.get("hinge_torque_Nm", [0] * 99)[j - 1])
        gain, damping, limit = body["servo_kp"], body["servo_kd"], body["servo_limit_Nm"]
        if gain > 0 or damping > 0:
            start, slope = gain * (target - ahead) + damping * rate, gain * h + damping
            if limit:
                self.elements.append(Element(row, -h * limit, h * limit, 1 / (h * slope), start / slope))
            else:
                self.mass[k, k] += h * slope
                self.push[k] += h * start
        if body["hinge_dry_Nm"] > 0:
            self.elements.append(Element(row, -h * body["hinge_dry_Nm"], h * body["hinge_dry_Nm"]))
        if body["stop_high_rad"] is not None:
            self.elements.append(Element(row, 0, INFINITE, 0, max(0, body["stop_high_rad"] - ahead) / h))
            self.elements.append(Element(row, -INFINITE, 0, 0, min(0, body["stop_low_rad"] - ahead) / h))
        if body["prescribed"]:
            self.elements.append(Element(row, -INFINITE, INFINITE, 0, rate))

    def _add_wheels(self, before: State, segment: Case) -> None:
        h, n = self.h, self.n
        self.rows, self.rims = np.zeros((self.count, 2, n)), np.zeros((self.count, 2))
        self.inertia, self.viscous, self.wheel_push = (np.zeros(self.count) for _ in range(3))
        self.grip, self.axle, self.creep = np.zeros(self.count), np.zeros(self.count), np.zeros(self.count)
        for i, wheel in enumerate(self.wheels):
            body, k = wheel["body"], wheel["roller_drag"]
            angle = wheel["axle_rad"] + wheel["roller_rad"] + self.tree.angle[body]
            u = np.array([np.cos(angle), np.sin(angle)])
            jacobian = self.tree.jacobian(body, self.tree.at(body, wheel["at_m"]))
            self.rows[i] = u @ jacobian, k * np.array([-u[1], u[0]]) @ jacobian
            self.rims[i] = (wheel["radius_m"] * np.sin(wheel["roller_rad"]),
                            k * wheel["radius_m"] * np.cos(wheel["roller_rad"]))
            self.inertia[i] = wheel["inertia_kgm2"]
            self.viscous[i] = h * wheel["motor_damping_Nms"]
            self.wheel_push[i] = (wheel["inertia_kgm2"] * before.wheel_speed[i]
                                  + h * wheel["motor_gain_Nm_per_V"] * segment.get("voltage_V", [0] * 99)[i])
            self.grip[i] = h * wheel["friction_coefficient"] * self.loads[i]
            self.axle[i] = h * wheel["axle_friction_Nm"]
            rolled = wheel["radius_m"] * abs(before.wheel_speed[i])
            self.creep[i] = rolled * wheel.get("creep", 0) / self.grip[i] if rolled >= 1e-6 else 0
            if wheel["scrub_radius_m"] > 0:
                bound, fade = self.grip[i] * wheel["scrub_radius_m"], wheel["scrub_fade_m"]
                row = np.concatenate([self.tree.turning(body), np.zeros(self.count)])
                speed = wheel["radius_m"] * abs(before.wheel_speed[i])
                rolls = fade > 0 and speed > 1e-6
                self.elements.append(Element(row, -bound, bound, speed / (fade * bound) if rolls else 0))

    # ------------------------------------------------------------------------------------- judging

    def give_forces(self, after: State) -> None:
        """Sets each element's q from the forces that the core found."""
        for element in self.elements:
            on = np.flatnonzero(element.row)
            if len(on) > 1 or on[0] == 2:
                continue
            j = on[0] - 3
            if element.high == INFINITE and element.low == -INFINITE:
                element.q = self.h * after.drive_Nm[j]
            elif element.high == INFINITE:
                element.q = self.h * after.stop_Nm[j][0]
            elif element.low == -INFINITE:
                element.q = self.h * after.stop_Nm[j][1]
            elif element.compliance > 0:
                element.q = self.h * after.drive_Nm[j]
            else:
                element.q = self.h * after.dry_Nm[j]
        scrubbing = [i for i, wheel in enumerate(self.wheels) if wheel["scrub_radius_m"] > 0]
        for i, element in zip(scrubbing, self.elements[len(self.elements) - len(scrubbing):], strict=True):
            element.q = self.h * after.scrub_Nm[i]

    def residual(self, after: State) -> float:
        """The larger of the equations' and the laws' residual, over the size of the free motion."""
        self.give_forces(after)
        factor = np.linalg.cholesky(self.mass)
        whiten = lambda x: solve_triangular(factor, x, lower=True)  # noqa: E731
        rest, worst = self.mass @ after.z - self.push, 0.0
        for i in range(self.count):
            p, s = self.h * after.grip_N[i], after.wheel_speed[i]
            slip = self.rows[i] @ after.z - self.rims[i] * s
            rest += p @ self.rows[i]
            mobility = sum(float(np.sum(whiten(row) ** 2)) for row in self.rows[i])
            mobility += float(np.sum(self.rims[i] ** 2)) / self.inertia[i] + self.creep[i]
            t = p + (slip - self.creep[i] * p) / mobility
            size = np.hypot(*t)
            projected = t * min(1, self.grip[i] / size) if size > 0 else t
            worst = max(worst, float(np.hypot(*(p - projected))) * np.sqrt(mobility))
            need = self.rims[i] @ p + self.wheel_push[i] - (self.inertia[i] + self.viscous[i]) * s
            law = np.clip(need + self.inertia[i] * s, -self.axle[i], self.axle[i])
            worst = max(worst, abs(need - law) / np.sqrt(self.inertia[i]))
        for element in self.elements:
            row = element.row[:self.n]
            rest += element.q * row
            mobility = float(np.sum(whiten(row) ** 2))
            away = row @ after.z - element.target - element.compliance * element.q
            t = np.clip(element.q + away / (mobility + element.compliance), element.low, element.high)
            worst = max(worst, abs(element.q - t) * np.sqrt(mobility + element.compliance))
        return max(float(np.linalg.norm(whiten(rest))), worst) / self.size()

    def size(self) -> float:
        """Size of the free motion: of bodies, wheels and what drives the elements."""
        factor = np.linalg.cholesky(self.mass)
        sum_ = float(np.sum(solve_triangular(factor, self.push, lower=True) ** 2))
        sum_ += float(np.sum(self.wheel_push ** 2 / (self.inertia + self.viscous)))
        for element in self.elements:
            mobility = float(np.sum(solve_triangular(factor, element.row[:self.n], lower=True) ** 2))
            if element.compliance > 0:
                q = np.clip(element.target / element.compliance, element.low, element.high)
                sum_ += q * q * mobility / (1 + mobility / element.compliance)
            elif element.low == -INFINITE and element.high == INFINITE:
                sum_ += element.target ** 2 / mobility
        return float(np.sqrt(sum_))

    def distance(self, z: Vector, s: Vector, other_z: Vector, other_s: Vector) -> float:
        """Of two motions, in the energy norm."""
        dz, ds = z - other_z, s - other_s
        return float(np.sqrt(dz @ self.mass @ dz + np.sum((self.inertia + self.viscous) * ds ** 2)))

    def cost(self, z: Vector, s: Vector) -> float:
        """What the step minimises, over the square of the free motion's size; without stops and prescribed rates."""
        total = 0.5 * z @ self.mass @ z - self.push @ z
        total += float(np.sum(0.5 * (self.inertia + self.viscous) * s ** 2 - self.wheel_push * s))
        total += float(np.sum(self.axle * np.abs(s)))
        for i in range(self.count):
            slip, turn = float(np.hypot(*(self.rows[i] @ z - self.rims[i] * s[i]))), self.grip[i] * self.creep[i]
            total += 0.5 * slip ** 2 / self.creep[i] if slip < turn else self.grip[i] * (slip - 0.5 * turn)
        for e in self.elements:
            if np.isinf(e.high) or np.isinf(e.low):
                continue
            away = e.row[:self.n] @ z - e.target
            turn = e.high * e.compliance  # from where on the element is at its bound
            if e.compliance > 0 and abs(away) <= turn:
                total += 0.5 * away ** 2 / e.compliance
            else:
                total += e.high * (abs(away) - 0.5 * turn)
        return float(total) / self.size() ** 2

    # ------------------------------------------------------------------------------------- solving

    def solved(self) -> tuple[Vector, Vector]:
        """z and s by Clarabel, in coordinates of unit energy."""
        import clarabel
        from scipy import sparse
        n, count = self.n, self.count
        factor = np.linalg.cholesky(self.mass)
        root = np.sqrt(self.inertia + self.viscous)
        scale = self.size()
        free = np.concatenate([solve_triangular(factor, self.push, lower=True), self.wheel_push / root]) / scale
        to_unit = lambda row: np.concatenate([  # noqa: E731
            solve_triangular(factor, row[:n], lower=True), row[n:] / root])
        dry: list[tuple[Vector, float, float]] = []  # row, target, bound
        inequality: list[tuple[Vector, float]] = []
        equality: list[tuple[Vector, float]] = []
        soft: list[tuple[Vector, float, float, float]] = []
        for i in range(count):
            if self.axle[i] > 0:
                dry.append((to_unit(self.unit(n + i)), 0.0, self.axle[i]))
        for e in self.elements:
            row = to_unit(e.row)
            if e.low == -INFINITE and e.high == INFINITE:
                equality.append((row, e.target))
            elif e.high == INFINITE:
                inequality.append((row, e.target))
            elif e.low == -INFINITE:
                inequality.append((-row, -e.target))
            elif e.compliance > 0:
                soft.append((row, e.target, e.compliance, e.high))
            else:
                dry.append((row, e.target, e.high))
        cones = [i for i in range(count) if self.grip[i] > 0]
        size = n + count + len(dry) + 2 * len(soft) + len(cones) + 2 * sum(self.creep[i] > 0 for i in cones)
        quadratic, linear = np.zeros((size, size)), np.zeros(size)
        quadratic[:n + count, :n + count] = np.eye(n + count)
        linear[:n + count] = -free
        rows: list[Vector] = []
        sides: list[float] = []

        def say(row: Vector, side: float) -> None:
            rows.append(row)
            sides.append(side)

        def wide(row: Vector | None = None, **at: float) -> Vector:
            out = np.zeros(size)
            if row is not None:
                out[:n + count] = row
            for key, value in at.items():
                out[int(key[1:])] = value
            return out

        for row, target in equality:
            say(wide(row) / np.linalg.norm(row), target / scale / np.linalg.norm(row))
        start = n + count
        for row, target, bound in dry:
            norm = np.linalg.norm(row)
            linear[start] = bound * norm / scale
            for sign in (1, -1):
                say(wide(sign * row / norm, **{f"i{start}": -1}), sign * target / scale / norm)
            start += 1
        for row, target, compliance, bound in soft:
            norm = np.linalg.norm(row)  # ½/compliance (x − target − a)² + bound |a|; a in units of the row
            d = wide(row / norm, **{f"i{start}": -1})
            weight = norm * norm / compliance
            quadratic += weight * np.outer(d, d)
            linear -= weight * (target / scale / norm) * d
            linear[start + 1] = bound * norm / scale
            for sign in (1, -1):
                say(wide(None, **{f"i{start}": sign, f"i{start + 1}": -1}), 0)
            start += 2
        for row, target in inequality:
            say(wide(row) / np.linalg.norm(row), target / scale / np.linalg.norm(row))
        flat = len(rows)
        for i in cones:
            both = [to_unit(np.concatenate([self.rows[i][k], -self.rims[i][k] * self.unit(n + i)[n:]]))
                    for k in range(2)]
            norm = np.linalg.norm(both)
            linear[start] = self.grip[i] * norm / scale
            say(wide(None, **{f"i{start}": -1}), 0)
            if self.creep[i] > 0:  # ½/creep |slip − a|² + grip |a|; a in units of the rows
                weight = norm * norm / self.creep[i]
                for k, row in enumerate(both):
                    d = wide(row / norm, **{f"i{start + 1 + k}": -1})
                    quadratic += weight * np.outer(d, d)
                    say(wide(None, **{f"i{start + 1 + k}": -1}), 0)
                start += 2
            for row in both if self.creep[i] == 0 else []:
                say(wide(-row / norm), 0)
            start += 1
        kinds = []
        if equality:
            kinds.append(clarabel.ZeroConeT(len(equality)))
        if flat > len(equality):
            kinds.append(clarabel.NonnegativeConeT(flat - len(equality)))
        kinds += [clarabel.SecondOrderConeT(3)] * len(cones)
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-14
        settings.max_iter = 200
        solution = clarabel.DefaultSolver(sparse.csc_matrix(np.triu(quadratic)), linear,
                                          sparse.csc_matrix(np.array(rows)), np.array(sides), kinds, settings).solve()
        x = np.array(solution.x)[:n + count] * scale
        return solve_triangular(factor.T, x[:n]), x[n:] / root
