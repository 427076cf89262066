"""The Kalman filter: against a dense one in NumPy in other coordinates, and against its own covariance in many runs."""

from __future__ import annotations

import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import laconic
from laconic import BadInput, Refused
from laconic.base.paths import SOURCE_DIR, built
from laconic.core.binding import load

OMNI = {"mass_kg": 10.0, "yaw_inertia_kgm2": 0.2, "com_x_m": 0.03, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.002,
        "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02,
        "wheel": [{"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0},
                  {"kind": "omni", "x_m": -0.1, "y_m": 0.0, "axle_rad": 3.0},
                  {"kind": "omni", "x_m": 0.0, "y_m": 0.12, "axle_rad": 1.5},
                  {"kind": "omni", "x_m": 0.02, "y_m": -0.12, "axle_rad": -1.4}]}
CART = {"mass_kg": 1.0, "yaw_inertia_kgm2": 3e-3, "com_x_m": -0.02, "wheel_radius_m": 0.033, "wheel_inertia_kgm2": 2e-5,
        "motor_gain_Nm_per_V": 0.125, "motor_damping_Nms": 0.235,
        "wheel": [{"kind": "fixed", "x_m": 0.0, "y_m": side * 0.08, "axle_rad": -math.pi / 2} for side in (1, -1)]}
STEP_S = 0.01
SETTINGS = {"voltage_noise_V_per_sqrt_Hz": 0.15, "force_noise_N_per_sqrt_Hz": 0.1, "moment_noise_Nm_per_sqrt_Hz": 0.01,
            "slip_noise_m_per_s_per_sqrt_Hz": 0.002, "yaw_slip_noise_rad_per_s_per_sqrt_Hz": 0.004,
            "bias_noise_rad_per_s2_per_sqrt_Hz": 1e-3, "nu_std_rad_per_s": 0.2, "position_std_m": 0.02,
            "heading_std_rad": 0.03, "bias_std_rad_per_s": 0.02, "encoder_std_rad": 2e-3,
            "yaw_rate_std_rad_per_s": 0.01}
PLACE = (0.1, 0.04)  # of what the camera sees


def plant_of(vehicle, real="double", **start):
    core = load(real)
    return core.plant(core.vehicle(vehicle), "auto", STEP_S, **start)


def held_at(step, wheels):
    return {"voltage_V": [4.0 * math.sin(0.03 * step + wheel) for wheel in range(wheels)]}


class Dense:
    """An extended Kalman filter as books have it: of (ν, x, y, θ, χ, bias), with full matrices and Joseph's form."""

    def __init__(self, plant, settings):
        self.plant, self.wheels, self.s = plant, plant.wheel_count, settings
        self.z = np.concatenate([plant.nu, plant.pose[:3], np.zeros(self.wheels), [0.0]])
        stds = [settings["nu_std_rad_per_s"]] * 3 + [settings["position_std_m"]] * 2 + [settings["heading_std_rad"]]
        p = np.diag(np.square([*stds, *([0.0] * self.wheels), settings["bias_std_rad_per_s"]]))
        allowed = np.eye(len(p))
        allowed[:3, :3] = self._projection()
        self.p = allowed @ p @ allowed.T

    def _projection(self):
        """ν ↦ the motion that the constraints leave, which is what the core starts from."""
        ffi, columns = self.plant.core.ffi, []
        for k in range(3):
            state = ffi.new("laconic_state *")
            start = ffi.new("laconic_start *", {"nu_rad_per_s": np.eye(3)[k].tolist()})
            model = ffi.addressof(self.plant.c, "model")
            self.plant.core.lib.laconic_state_project(state, model, start, ffi.NULL)
            nu = ffi.new("laconic_real[3]")
            self.plant.core.lib.laconic_nu(model, state, nu)
            columns.append(list(nu))
        return np.transpose(columns)

    def at(self, z):
        plant = self.plant
        ffi, lib = plant.core.ffi, plant.core.lib
        start = ffi.new("laconic_start *", {"nu_rad_per_s": z[:3].tolist(), "x_m": z[3], "y_m": z[4],
                                            "heading_rad": z[5]})
        lib.laconic_state_project(ffi.addressof(plant.c, "state"), ffi.addressof(plant.c, "model"), start, ffi.NULL)
        return plant

    def predict(self, held):
        plant, n = self.at(self.z), self.wheels
        jacobian = plant.step_derivatives(held).jacobian()
        plant.run(held)
        after = np.concatenate([plant.nu, plant.pose[:3], self.z[6:-1] + plant.wheel_angles(), self.z[-1:]])
        f, s, half_rate = np.eye(7 + n), self.s, 0.5 / STEP_S
        f[:-1, :-1] = jacobian.by_state
        noise = {f"voltage_V[{i + 1}]": s["voltage_noise_V_per_sqrt_Hz"] for i in range(n)}
        noise |= {f"body_force_N[{k}]": s["force_noise_N_per_sqrt_Hz"] for k in (1, 2)}
        noise["body_moment_Nm"] = s["moment_noise_Nm_per_sqrt_Hz"]
        b = np.zeros((7 + n, len(noise)))
        for column, (name, density) in enumerate(noise.items()):
            b[:-1, column] = jacobian.by_input[:, jacobian.input_names.index(name)] * density
        q = b @ b.T * half_rate
        slip = [s["slip_noise_m_per_s_per_sqrt_Hz"]] * 2 + [s["yaw_slip_noise_rad_per_s_per_sqrt_Hz"]]
        q[range(3, 6), range(3, 6)] += np.square(slip) * STEP_S / 2
        q[-1, -1] += s["bias_noise_rad_per_s2_per_sqrt_Hz"] ** 2 * STEP_S / 2
        self.z, self.p = after, f @ self.p @ f.T + q

    def read(self, h, residual, noise):
        s = h @ self.p @ h.T + noise
        gain = np.linalg.solve(s, h @ self.p).T
        rest = np.eye(len(self.p)) - gain @ h
        self.z, self.p = self.z + gain @ residual, rest @ self.p @ rest.T + gain @ noise @ gain.T
        return residual @ np.linalg.solve(s, residual)

    def encoders(self, angle):
        h = np.zeros((self.wheels, len(self.z)))
        h[:, 6:-1] = np.eye(self.wheels)
        noise = np.eye(self.wheels) * self.s["encoder_std_rad"] ** 2
        return self.read(h, angle - self.z[6:-1], noise)

    def yaw_rate(self, shown):
        h = np.zeros((1, len(self.z)))
        scale = self.plant.core.matrices(self.plant.core.ffi.addressof(self.plant.c, "vehicle")).lambda_yaw
        h[0, 2], h[0, -1] = 1 / scale, 1.0
        noise = np.array([[self.s["yaw_rate_std_rad_per_s"] ** 2]])
        return self.read(h, np.array([shown - self.z[2] / scale - self.z[-1]]), noise)

    def fix(self, seen, std, heading_std):
        model, theta = self.plant.c.model, self.z[5]
        turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        arm = turn @ (np.array(PLACE) - [model.com_x_m, model.com_y_m])
        h = np.zeros((3, len(self.z)))
        h[:, 3:6] = np.eye(3)
        h[0, 5], h[1, 5] = -arm[1], arm[0]
        off = np.array([*(seen[:2] - self.z[3:5] - arm), math.remainder(seen[2] - theta, 2 * math.pi)])
        return self.read(h, off, np.diag(np.square([std, std, heading_std])))


class World:
    """A true vehicle with the noise that SETTINGS tell of, and its instruments."""

    def __init__(self, plant, random):
        self.plant, self.random, s = plant, random, SETTINGS
        self.bias = random.normal() * s["bias_std_rad_per_s"]
        self.slipped = np.zeros(3)
        self.shown = np.zeros(plant.wheel_count)

    def held_noise(self, name, count):
        return self.random.normal(size=count) * SETTINGS[name] * math.sqrt(0.5 / STEP_S)

    def step(self, held):
        n = self.plant.wheel_count
        volts = np.array(held["voltage_V"]) + self.held_noise("voltage_noise_V_per_sqrt_Hz", n)
        self.plant.run({"voltage_V": volts, "body_force_N": self.held_noise("force_noise_N_per_sqrt_Hz", 2),
                        "body_moment_Nm": self.held_noise("moment_noise_Nm_per_sqrt_Hz", 1)[0]})
        self.slipped[:2] += self.held_noise("slip_noise_m_per_s_per_sqrt_Hz", 2) * STEP_S
        self.slipped[2] += self.held_noise("yaw_slip_noise_rad_per_s_per_sqrt_Hz", 1)[0] * STEP_S
        self.bias += self.held_noise("bias_noise_rad_per_s2_per_sqrt_Hz", 1)[0] * STEP_S

    def angles(self):
        return self.plant.wheel_angles() + self.random.normal(size=self.plant.wheel_count) * SETTINGS["encoder_std_rad"]

    def turned(self):
        before, self.shown = self.shown, self.angles()
        return self.shown - before

    def yaw_rate(self):
        noise = self.random.normal() * SETTINGS["yaw_rate_std_rad_per_s"]
        return self.plant.body_velocity()[1] + self.bias + noise


@pytest.mark.parametrize("vehicle", [OMNI, CART], ids=["omni", "differential"])
def test_the_filter_is_the_dense_one_of_the_books(vehicle):
    random = np.random.default_rng(4)
    start = {"nu_rad_per_s": (1.0, 0.0, 0.0) if vehicle is CART else (1.0, -0.5, 2.0), "heading_rad": 3.0}
    world = World(plant_of(vehicle, **start), random)
    ours, dense = laconic.Filter(plant_of(vehicle, **start), SETTINGS), Dense(plant_of(vehicle, **start), SETTINGS)
    for step in range(120):
        held = held_at(step, world.plant.wheel_count)
        world.step(held)
        ours.predict(held)
        dense.predict(held)
        squares = []
        if step % 2:
            squares.append((ours.encoders(world.turned()).square, dense.encoders(world.shown)))
        if step % 3 == 0:
            shown = world.yaw_rate()
            squares.append((ours.yaw_rate(shown).square, dense.yaw_rate(shown)))
        if step % 20 == 7:
            seen = np.array([0.01 * step, 0.02, 3.0 - 0.004 * step])
            squares.append((ours.fix(*seen, std_m=0.5, heading_std_rad=0.4, place_m=PLACE).square,
                            dense.fix(seen, 0.5, 0.4)))
        for mine, theirs in squares:
            assert mine == pytest.approx(theirs, rel=1e-7)
        expected = np.concatenate([dense.at(dense.z).nu, dense.z[3:6], dense.z[-1:]])
        assert ours.state == pytest.approx(expected, rel=1e-9, abs=1e-10)
        rows = [0, 1, 2, 3, 4, 5, len(dense.z) - 1]
        scale = np.sqrt(np.diag(dense.p)[rows])
        assert np.all(np.abs(ours.covariance - dense.p[np.ix_(rows, rows)]) <= 1e-9 * np.outer(scale, scale) + 1e-15)


def normalised_squares(random, steps):
    """NEES of (ν, θ, bias) and pose at the end of a run, and the mean NIS of its readings."""
    first = plant_of(OMNI, nu_rad_per_s=(1.0, -0.5, 2.0))
    ours = laconic.Filter(first, SETTINGS)
    off = np.sqrt(np.diag(ours.covariance)) * random.normal(size=7)
    world = World(plant_of(OMNI, nu_rad_per_s=np.array([1.0, -0.5, 2.0]) + off[:3]), random)
    start_off, found = off[3:6], []
    for step in range(steps):
        held = held_at(step, 4)
        world.step(held)
        ours.predict(held)
        if step % 2:
            found += [ours.encoders(world.turned()), ours.yaw_rate(world.yaw_rate())]
    pose = world.plant.pose
    truth = np.array([*world.plant.nu, pose.x_m, pose.y_m, pose.heading_rad, world.bias])
    turn = start_off[2]  # the world's run began with another heading, which turns its whole path
    path = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]) @ truth[3:5]
    truth[3:5] = path + start_off[:2]
    truth[5] += turn
    truth[3:6] += world.slipped
    error = truth - ours.state
    return error @ np.linalg.solve(ours.covariance, error), np.sum(found, axis=0)


@pytest.mark.nightly
def test_errors_are_as_large_as_the_covariance_says():
    """Means of χ² over seeded runs lie in the band in which 95 % of such means lie."""
    random, runs = np.random.default_rng(12), 60
    results = [normalised_squares(random, 80) for _ in range(runs)]
    nees = np.mean([square for square, _ in results])
    numbers, nis = np.sum([found for _, found in results], axis=0)
    assert abs(nees - 7) <= 1.96 * math.sqrt(2 * 7 / runs)
    assert abs(nis / numbers - 1) <= 1.96 * math.sqrt(2 / numbers)


def test_single_precision_gives_the_estimate_of_double_precision():
    states = []
    for real in ("double", "single"):
        random = np.random.default_rng(9)
        world, ours = World(plant_of(OMNI), random), laconic.Filter(plant_of(OMNI, real), SETTINGS)
        for step in range(300):
            held = held_at(step, 4)
            world.step(held)
            ours.predict(held)
            ours.encoders(world.turned())
            ours.yaw_rate(world.yaw_rate())
        states.append((ours.state, np.sqrt(np.diag(ours.covariance))))
    assert np.all(np.abs(states[1][0] - states[0][0]) <= 0.02 * states[0][1])
    assert states[1][1] == pytest.approx(states[0][1], rel=2e-3)


def test_counts_are_angles_by_the_shorter_way_round_and_their_rounding_does_not_add_up():
    encoder = {"counts_per_turn": 512, "gear_ratio": -2.0, "wrap": 1000}
    plant = plant_of(OMNI)
    quiet = {"voltage_noise_V_per_sqrt_Hz": 0.05, "encoder_std_rad": 0.41 * 2 * math.pi / 1024, "nu_std_rad_per_s": 0.0}
    sensors, ours = plant.sensors({"encoder": encoder}), laconic.Filter(plant_of(OMNI), quiet, encoder=encoder)
    for _ in range(300):
        sensors.run({"voltage_V": [6.0, -4.0, 5.0, 3.0]})
        ours.predict({"voltage_V": [5.0, -4.2, 5.0, 3.3]})  # the filter does not know the voltages well
        ours.counts(sensors.read().encoder_count)
    away = math.hypot(ours.pose.x_m - plant.pose.x_m, ours.pose.y_m - plant.pose.y_m)
    assert abs(ours.pose.heading_rad) > 1.0  # far enough for wrong counts to show
    assert away < 0.002
    assert ours.pose.heading_rad == pytest.approx(plant.pose.heading_rad, abs=0.02)


def test_what_is_refused_changes_nothing():
    ours = laconic.Filter(plant_of(OMNI), SETTINGS, encoder={"counts_per_turn": 100})
    ours.predict({"voltage_V": [1.0, 2.0, 3.0, 4.0]})
    before = bytes(ours.core.ffi.buffer(ours.core.ffi.addressof(ours.c, "covariance"))), ours.state.tolist()
    for call, text in ((lambda: ours.predict({"voltage_V": [math.nan, 0, 0, 0]}), "not a finite number"),
                       (lambda: ours.encoders([0, 0, math.nan, 0]),
                        r"turned_rad\[3\]: nan is not finite; give finite numbers in rad"),
                       (lambda: ours.encoders([0, 0]), "turned_rad"), (lambda: ours.counts([0, 0, 0.5, 0]), "count"),
                       (lambda: ours.yaw_rate(math.inf), "shown_rad_per_s: inf is not finite"),
                       (lambda: ours.yaw_rate(1e200), "shown_rad_per_s: takes the estimate"),
                       (lambda: ours.fix(0, 0), "give std_m or heading_std_rad"),
                       (lambda: ours.fix(0, 0, std_m=-1), "below 0"),
                       (lambda: ours.fix(math.nan, 0, std_m=1), "finite")):
        with pytest.raises((BadInput, Refused), match=text):
            call()
        now = bytes(ours.core.ffi.buffer(ours.core.ffi.addressof(ours.c, "covariance"))), ours.state.tolist()
        assert now == before


@pytest.mark.parametrize(("settings", "text"), [
    ({"encoder_std": 1.0}, "settings.encoder_std: unknown key; .*encoder_std_rad"), ({"position_std_m": -1.0}, "-1"),
    ({"encoder_std_rad": [0.1, 0.2]}, "encoder_std_rad"), ({"bias_std_rad_per_s": math.nan}, "nan"), (3, "no table")])
def test_settings_that_make_no_sense_are_refused_by_name(settings, text):
    with pytest.raises(BadInput, match=text):
        laconic.Filter(plant_of(OMNI), settings)


def test_instruments_that_the_settings_do_not_have_are_refused():
    ours = laconic.Filter(plant_of(OMNI), {})
    for call, text in ((lambda: ours.encoders([0] * 4), "encoder_std_rad"), (lambda: ours.counts([0] * 4), "encoder"),
                       (lambda: ours.yaw_rate(0.0), "yaw_rate_std_rad_per_s")):
        with pytest.raises(BadInput, match=text):
            call()


def test_a_vehicle_with_friction_is_refused():
    with pytest.raises(BadInput, match="friction_coefficient"):
        laconic.Filter(plant_of({**OMNI, "ground": {"friction_coefficient": 0.5}}), {})


def test_a_saved_filter_goes_on_as_it_was():
    ours = laconic.Filter(plant_of(OMNI), SETTINGS)
    saved = ours.save()
    first = ours.state.copy()
    ours.predict({"voltage_V": [1.0, 2.0, 3.0, 4.0]}, steps=5)
    ours.encoders([0.1, 0.2, 0.3, 0.4])
    assert not np.array_equal(ours.state, first)
    ours.restore(saved)
    assert np.array_equal(ours.state, first)


def test_what_another_robots_filter_saved_is_refused():
    ours = laconic.Filter(plant_of(OMNI), SETTINGS)
    before = ours.state.copy()
    for saved in (None, (1, 2), laconic.Filter(plant_of({**OMNI, "wheel": OMNI["wheel"][:3]}), {}).save()):
        with pytest.raises(BadInput, match=r"saved: .*is not of this filter"):
            ours.restore(saved)
    assert np.array_equal(ours.state, before)


# ---- The page's program in C compiles against the core as it is shipped, and prints what the page says.

PAGE = (SOURCE_DIR / "docs/control.md").read_text(encoding="utf-8")


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_page_s_program_compiles_and_prints_what_the_page_says(tmp_path: Path) -> None:
    _, _, rest = PAGE.partition("```c\n")
    program, _, rest = rest.partition("```\n")
    shown = rest.partition("```text\n")[2].partition("```")[0]
    (tmp_path / "program.c").write_text(program, encoding="utf-8")
    subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{SOURCE_DIR / 'core_c/include'}", "program.c",
                    str(built("core_c/liblaconic.a")), "-o", "program"], cwd=tmp_path, check=True)
    printed = subprocess.run(["./program"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert printed == shown
