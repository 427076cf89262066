"""Many vehicles that step together, as numpy arrays with one number for each lane.

    batch = Batch(robot, lanes=1000, method="auto", step_s=0.01)
    batch.voltage_V[:] = voltages                   # (N, lanes)
    batch.run(steps=100)
    batch.x_m, batch.heading_rad, batch.status      # (lanes,) each
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np

from laconic.batch.given import check_steppable, core_of, kinds_of, kinds_of_lanes, thread_count
from laconic.batch.memory import Rows, aligned_memory
from laconic.batch.population import Kinds, items_of, zeros
from laconic.core import Vehicle
from laconic.core.copies import OwnMemory, build_of, packed, unpacked
from laconic.core.given import c_object, finite_number, number, shown, step_count, whole_number
from laconic.core.given_array import fill, real_array
from laconic.errors import BadInput, Refused

MOST_AT_ONCE = 2**24  # steps of all lanes in one call, a tenth of a second or two;
FEWEST_AT_ONCE = 256  # of each: a call reads what a kind is made of
ONE = 1  # the usual number of threads
INPUTS = ("voltage_V", "axle_torque_Nm", "body_force_N", "body_moment_Nm", "world_force_N", "world_force_point_m")
PRIVATE = ("_pool", "_pool_process", "_is_observed")


class Batch(OwnMemory):
    """Vehicles side by side, each with the bits and the refusals that `Plant.run` would give it alone.

    `vehicles`: one for all lanes, or several kinds of one scalar type; then `kind_of` has for each lane the index of
    its kind, from 0, and without it there is one lane for each. `lanes`: how many, where one vehicle is for all.
    `width_bytes`: of the registers (16, 32, 64; 1: lanes one by one), the widest that there are by default. All lanes
    begin at rest at the origin without input.

    Inputs and outputs are views of the batch's own memory, nothing is copied: inputs may be written in place.
    Raises BadInput for what does not fit and for a vehicle with friction or a drive, which a batch does not step;
    Refused as `Vehicle.plant` does. A copy, or a batch from a pickle, has memory of its own and the same bits.
    """

    voltage_V: np.ndarray             # (N, lanes)  input; N wheels of the vehicle that has most  # noqa: N815
    axle_torque_Nm: np.ndarray        # (N, lanes)  input                                         # noqa: N815
    body_force_N: np.ndarray          # (2, lanes)  input, along and across                       # noqa: N815
    body_moment_Nm: np.ndarray        # (lanes,)    input                                         # noqa: N815
    world_force_N: np.ndarray         # (2, lanes)  input                                         # noqa: N815
    world_force_point_m: np.ndarray   # (2, lanes)  input, from the centre of mass in body axes
    x_m: np.ndarray                   # (lanes,)    of the centre of mass; read only
    y_m: np.ndarray                   # (lanes,)    read only
    status: np.ndarray                # (lanes,)    int32: 0, or why the lane's last run was refused
    missed: np.ndarray                # (lanes,)    uint64: steps since its start that the lane did not take

    def __init__(self, vehicles: Vehicle | Sequence[Vehicle], lanes: int | None = None, method: str = "auto",
                 step_s: float = 1e-3, *, kind_of: Sequence[int] | np.ndarray | None = None, width_bytes: int = 0):
        kinds = kinds_of(vehicles)
        core = self.core = core_of(kinds)
        self._kind_of = kinds_of_lanes(len(kinds), lanes, kind_of)
        self.lane_count, self.step_s = len(self._kind_of), number("step_s", step_s)
        self._has_own_kinds = len(kinds) == self.lane_count == len(np.unique(self._kind_of))
        self._kinds = core.ffi.new("laconic_batch_kind[]", len(kinds))
        for item, vehicle in enumerate(kinds):
            self._prepare(item, vehicle, method)
        if not 0 <= whole_number("width_bytes", width_bytes) < 2**31 or core.lib.laconic_batch_width(width_bytes) == 0:
            raise BadInput(f"width_bytes: this processor has no registers of {shown(width_bytes)} bytes; give 0 for "
                           "the widest that it has")
        self._place(max(vehicle.wheel_count for vehicle in kinds), width_bytes)
        self._is_placed = True

    @classmethod
    def of_kinds(cls, kinds: Kinds) -> Batch:
        """One lane for each kind of a population; precondition: none was refused (`Kinds.usable`), there is one."""
        made = cls.__new__(cls)
        made.core, made._kind_of = kinds.core, np.arange(len(kinds.kinds), dtype=np.int32)
        made.lane_count, made.step_s = len(kinds.kinds), kinds.step_s
        made._kinds, made._has_own_kinds = items_of(kinds.core, "laconic_batch_kind", kinds.kinds), True
        made._place(kinds.wheel_count, 0)
        made._is_placed = True
        return made

    def __setattr__(self, name: str, value: Any) -> None:
        """An input as a whole is written into the batch's memory; BadInput for what is none."""
        if not self.__dict__.get("_is_placed") or name in PRIVATE:
            super().__setattr__(name, value)
        elif name in INPUTS:
            fill(name, self.__dict__[name], value)
        else:
            raise BadInput(f"{name}: is no input of a batch; set {', '.join(INPUTS)}")

    def _prepare(self, item: int, vehicle: Vehicle, method: str) -> None:
        check_steppable(vehicle, f"vehicles[{item + 1}]")
        core, why = self.core, self.core.why()
        core.check(core.lib.laconic_batch_kind_of(self._kinds + item, vehicle.c, core.method(method), self.step_s, why),
                   why)

    def _place(self, wheel_count: int, width_bytes: int) -> None:
        ffi, lib = self.core.ffi, self.core.lib
        shape = ffi.new("laconic_batch_shape *", [self.lane_count, len(self._kinds), wheel_count, width_bytes])
        self._memory = aligned_memory(lib.laconic_batch_size(shape))
        self.c = ffi.new("laconic_batch *")
        kind_of = ffi.from_buffer("int32_t[]", self._kind_of)
        if not lib.laconic_batch_place(self.c, ffi.from_buffer(self._memory), shape, self._kinds, kind_of):
            raise BadInput("batch: does not fit the core's bounds")  # not reached: all is checked above
        rows = Rows(self.core, self.c, self._memory, self.lane_count)
        self.voltage_V, self.axle_torque_Nm = rows.of_wheels("VOLTAGE"), rows.of_wheels("AXLE_TORQUE")
        self.body_force_N, self.world_force_N = rows.many("BODY_FORCE_X", 2), rows.many("WORLD_FORCE_X", 2)
        self.world_force_point_m = rows.many("WORLD_FORCE_POINT_X", 2)
        self.body_moment_Nm = rows.one("BODY_MOMENT")
        self.x_m, self.y_m = rows.read_only(rows.one("X")), rows.read_only(rows.one("Y"))
        self._heading, self._nu = rows.read_only(rows.one("HEADING")), rows.read_only(rows.many("NU_1", 3))
        self.status, self.missed = rows.of_lanes(self.c.status, np.int32), rows.of_lanes(self.c.missed, np.uint64)
        self._is_observed = False
        self._pool: ThreadPoolExecutor | None = None
        self._pool_process = 0
        self._blocks, self._run_blocks = int(self.c.block_count), lib.laconic_batch_run
        self._at_once = max(FEWEST_AT_ONCE, MOST_AT_ONCE // self.lane_count)

    @property
    def width_bytes(self) -> int:
        """Of the registers that step the lanes; 1: one by one."""
        return int(self.c.shape.width_bytes)

    # ---- copies

    def __getstate__(self) -> dict[str, Any]:
        """What another batch of the same lanes needs, also on a processor with other registers."""
        kind, own = "laconic_batch_kind", self.core.ffi.buffer(self._kinds, self.core.ffi.sizeof(self._kinds))
        states = zeros(self.core, "laconic_state", self.lane_count)
        items = items_of(self.core, "laconic_state", states)
        for lane in range(self.lane_count):
            self.core.lib.laconic_batch_store(self.c, lane, items + lane)
        return {"core": self.core, "kind_of": self._kind_of, "kinds": packed(self.core, kind, bytes(own)),
                "kind_count": len(self._kinds), "build": build_of(self.core), "step_s": self.step_s,
                "wheel_count": int(self.c.shape.wheel_count), "width_bytes": self.width_bytes,
                "has_own_kinds": self._has_own_kinds, "states": states,
                "rows": {name: np.array(self.__dict__[name]) for name in (*INPUTS, "status", "missed")}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Places the lanes anew and loads their states, inputs and refusals."""
        core = self.core = state["core"]
        kind, ffi = "laconic_batch_kind", core.ffi
        self._kind_of, self.lane_count, self.step_s = state["kind_of"], len(state["kind_of"]), state["step_s"]
        self._has_own_kinds, self._kinds = state["has_own_kinds"], ffi.new(f"{kind}[]", state["kind_count"])
        data, distances = state["kinds"]
        data = unpacked(core, kind, data, distances, state["build"])
        ffi.memmove(self._kinds, data, len(data))
        width = state["width_bytes"]
        self._place(state["wheel_count"], width if core.lib.laconic_batch_width(width) else 0)
        items = items_of(core, "laconic_state", state["states"])
        for lane in range(self.lane_count):
            core.lib.laconic_batch_load(self.c, lane, items + lane)
        for name, row in state["rows"].items():
            target = self.__dict__[name]
            is_read_only = not target.flags.writeable
            target.flags.writeable = True
            target[...] = row
            target.flags.writeable = not is_read_only
        self._is_placed = True

    # ---- motion

    def start(self, lane: int, *, nu_rad_per_s: Sequence[float] = (0.0, 0.0, 0.0), x_m: float = 0.0, y_m: float = 0.0,
              heading_rad: float = 0.0) -> None:
        """Puts one lane at a start; its inputs stay. Raises Refused for one that the constraints forbid."""
        ffi, lib, why = self.core.ffi, self.core.lib, self.core.why()
        state, kind = ffi.new("laconic_state *"), self._kinds[self._kind_of[self._lane(lane)]]
        start = ffi.new("laconic_start *", {
            "nu_rad_per_s": real_array("nu_rad_per_s", nu_rad_per_s, (3,), "rad/s").tolist(),
            "x_m": finite_number("x_m", x_m), "y_m": finite_number("y_m", y_m),
            "heading_rad": finite_number("heading_rad", heading_rad)})
        self.core.check(lib.laconic_state_set(state, ffi.addressof(kind, "model"), start, why), why)
        self.load(lane, state)

    def prepared(self, vehicle: Vehicle, method: str = "auto") -> Any:
        """A vehicle as `change` takes it, for any number of lanes; refused as the batch's own."""
        core, why, found = self.core, self.core.why(), self.core.ffi.new("laconic_batch_kind *")
        if core_of([vehicle]) is not core:
            raise BadInput(f"vehicle: is of {vehicle.core.real} precision, the batch of {core.real}; give one of that")
        check_steppable(vehicle, "vehicle")
        core.check(core.lib.laconic_batch_kind_of(found, vehicle.c, core.method(method), self.step_s, why), why)
        return found

    def change(self, lane: int, prepared: Any) -> None:
        """Makes a lane another vehicle, at rest at the origin; its inputs stay. For batches of one kind for each lane.

        BadInput where lanes share kinds, and for a vehicle that is stepped in another way: another method chosen by
        auto, fast damping beside slow, other wheels, a slope.
        """
        index = int(self._kind_of[self._lane(lane)])
        if not self._has_own_kinds:
            raise BadInput(f"lane: {lane} shares its kind with others; give the batch as many vehicles as lanes")
        before = self.core.ffi.new("laconic_batch_kind *", self._kinds[index])
        self._kinds[index] = c_object(self.core, "batch_kind", prepared)[0]
        if not self.core.lib.laconic_batch_renew(self.c, lane):
            self._kinds[index] = before[0]
            raise BadInput("prepared: this vehicle is stepped in another way than the lane's; choose a shorter step or "
                           "one method for all")
        self.start(lane)

    def load(self, lane: int, state: Any) -> None:
        """Gives a lane a laconic_state, such as `plant.save()` has."""
        self.core.lib.laconic_batch_load(self.c, self._lane(lane), c_object(self.core, "state", state))
        self._is_observed = False

    def state(self, lane: int) -> Any:
        """A copy of a lane's laconic_state, all of it: `Plant.restore` takes it."""
        state = self.core.ffi.new("laconic_state *")
        self.core.lib.laconic_batch_store(self.c, self._lane(lane), state)
        return state

    def run(self, steps: int = 1, threads: int = 1) -> int:
        """Steps of all lanes with the inputs held, on so many threads; the bits do not depend on their number.

        A lane stops before a step that is refused, the others go on. Returns how many lanes were refused; `status` and
        `refusal` tell which and why.
        """
        left = step_count("steps", steps)
        if left <= self._at_once and threads is ONE:  # nothing that a thousand lanes' step would notice
            self.__dict__["_is_observed"] = False
            return self._run_blocks(self.c, 0, self._blocks, left)
        refused = -1
        while left or refused < 0:  # Ctrl-C is heard between calls; a refused lane is refused in each of them
            now = min(left, self._at_once)
            refused, left = self._in_parts(partial(self._run_part, now), threads), left - now
        return refused

    def _run_part(self, steps: int, first: int, count: int) -> int:
        return int(self._run_blocks(self.c, first, count, steps))

    def run_sampled(self, voltage_V: Any, steps_each: int = 1, threads: int = 1) -> int:  # noqa: N803
        """Steps with voltages that change on the way: voltage_V (samples, N, lanes), each held for `steps_each` steps.

        The bits are those of `run(steps_each)` after each sample was written into `voltage_V`; a lane that is refused
        takes no more steps. It saves a call for each sample. A C-contiguous array of the batch's scalar type is not
        copied. Returns how many lanes were refused.
        """
        steps, run = step_count("steps_each", steps_each), self.core.lib.laconic_batch_run_sampled
        samples = self._samples(voltage_V)
        given = self.core.ffi.from_buffer("laconic_real[]", samples)
        return self._in_parts(lambda first, count: int(run(self.c, first, count, len(samples), steps, given)), threads)

    def _samples(self, given: Any) -> np.ndarray:
        shape = ("samples", *self.voltage_V.shape)
        return real_array("voltage_V", given, shape, "V", dtype=self.core.dtype, is_finite=False)

    def _in_parts(self, work: Callable[[int, int], int], threads: int) -> int:
        """The sum of work on equal parts of the blocks at the same time; calls of the core let other threads run."""
        threads, blocks, self._is_observed = thread_count(threads), int(self.c.block_count), False
        if (threads := min(threads, blocks)) <= 1:
            return work(0, blocks)
        pool = self._pool_of(threads)
        edges = [blocks * part // threads for part in range(threads + 1)]
        jobs = [pool.submit(work, first, end - first) for first, end in zip(edges, edges[1:], strict=False)]
        return sum(job.result() for job in jobs)

    def _pool_of(self, threads: int) -> ThreadPoolExecutor:
        """Threads of this process: os.fork() takes the pool along, and its threads not."""
        if self._pool is None or self._pool._max_workers < threads or self._pool_process != os.getpid():
            self._pool, self._pool_process = ThreadPoolExecutor(threads, "laconic-batch"), os.getpid()
        return self._pool

    # ---- outputs

    @property
    def heading_rad(self) -> np.ndarray:
        """Unwrapped, shape (lanes,); as of now, a view that the next reading after a run renews. O(lanes) then."""
        self._observe()
        return self._heading

    @property
    def nu_rad_per_s(self) -> np.ndarray:
        """ν, shape (3, lanes); as `heading_rad`."""
        self._observe()
        return self._nu

    def _observe(self) -> None:
        if not self._is_observed:
            self.core.lib.laconic_batch_observe(self.c, 0, self.c.block_count)
            self._is_observed = True

    def refusal(self, lane: int) -> Refused | None:
        """Why a lane's last run was refused, as an exception with its message; None where it was not."""
        core, lane = self.core, self._lane(lane)
        if self.status[lane] == core.lib.LACONIC_OK:
            return None
        kind, why, held = self._kinds[self._kind_of[lane]], core.why(), core.ffi.new("laconic_input *")
        core.lib.laconic_batch_input(self.c, lane, held)
        model, integrator = core.ffi.addressof(kind, "model"), core.ffi.addressof(kind, "integrator")
        core.lib.laconic_step_refusal(why, int(self.status[lane]), model, integrator, self.state(lane), held, 1)
        return core.refusal(why)

    def _lane(self, lane: int) -> int:
        found = whole_number("lane", lane)
        if not 0 <= found < self.lane_count:
            raise BadInput(f"lane: there is no {found}; this batch has the lanes 0 to {self.lane_count - 1}")
        return found
