"""Many vehicles with hinges that step together, as numpy arrays with one number for each lane.

    batch = ArticulatedBatch(car, lanes=1000, method="auto", step_s=0.01)
    batch.of("voltage_V")[:] = voltages             # (N, lanes)
    batch.of("steering_twist")[2] = turns           # (lanes,)
    batch.run(steps=100, threads=2)
    batch.motion["hinge_angle_rad"], batch.status   # (lanes, most hinges), (lanes,)
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from laconic.batch.given import core_of, kinds_of, kinds_of_lanes, thread_count
from laconic.batch.population import items_of, zeros
from laconic.core.articulated import ArticulatedVehicle
from laconic.core.articulated_input import by_signal
from laconic.core.copies import OwnMemory
from laconic.core.given import c_object, number, shown, step_count, whole_number
from laconic.core.given_array import fill
from laconic.core.slipping import SlippingVehicle
from laconic.errors import BadInput, Refused

MOST_AT_ONCE = 2**20  # steps of all lanes in one call, about a second; Ctrl-C is heard between calls
OF_WHEELS = ("voltage_V", "axle_torque_Nm")
IDEAL, TREES = ("states", "inputs"), ("tree_states", "tree_inputs")
"""Members of laconic_articulated_batch by the ground."""
GROUND = ("ideal ground", "ground with friction")


class ArticulatedBatch(OwnMemory):
    """Vehicles with hinges side by side, each with the bits and the refusals of `ArticulatedPlant.run` alone.

    `vehicles`: one for all lanes, or several kinds; `kind_of` has for each lane the index of its kind, from 0, and
    without it there is one lane for each. All are on ideal ground, or all on ground with friction (SlippingVehicle),
    whose method is auto. All lanes begin at rest at the origin without input. Raises BadInput for
    what does not fit, and Refused as `ArticulatedVehicle.plant` does; both name the vehicle by its number from 1.
    """

    status: np.ndarray  # (lanes,)  int32: 0, or why the lane's last run was refused; read only
    missed: np.ndarray  # (lanes,)  uint64: steps that the lane did not take; read only

    def __init__(self, vehicles: ArticulatedVehicle | Sequence[ArticulatedVehicle], lanes: int | None = None,
                 method: str = "auto", step_s: float = 1e-3, *, kind_of: Sequence[int] | np.ndarray | None = None):
        self.vehicles = kinds_of(vehicles)
        core = self.core = core_of(self.vehicles, ArticulatedVehicle, "Batch")
        self._kind_of = kinds_of_lanes(len(self.vehicles), lanes, kind_of)
        self._slips = _slip(self.vehicles)
        self._form = "tree" if self._slips else "articulated"
        self.lane_count, self.step_s = len(self._kind_of), number("step_s", step_s)
        self.method, rest = method, self._prepared(method)
        self._states = zeros(core, f"laconic_{self._form}_state", self.lane_count)
        self._inputs = np.zeros((self.lane_count, len(self.vehicles[0].input_row())), core.dtype)
        self._motions = zeros(core, "laconic_articulated_motion", self.lane_count)
        self._why = core.ffi.new("laconic_refusal[]", self.lane_count)
        self.status, self.missed = np.zeros(self.lane_count, np.int32), np.zeros(self.lane_count, np.uint64)
        self._place()
        for lane in range(self.lane_count):
            self._items[lane] = rest[self._kind_of[lane]][0]

    def _prepared(self, method: str) -> list[Any]:
        """Fills the kinds; returns each vehicle's state at rest."""
        self._kinds, rest = self.core.ffi.new("laconic_articulated_kind[]", len(self.vehicles)), []
        for item, vehicle in enumerate(self.vehicles):
            try:
                plant = vehicle.plant(method, self.step_s)
            except Refused as refused:
                raise _named(f"vehicles[{item + 1}]", refused) from None
            except BadInput as wrong:
                raise BadInput(f"vehicles[{item + 1}]: {wrong}") from None
            if self._slips:
                self._kinds[item].tree, self._kinds[item].tree_step_s = vehicle.model, self.step_s
            else:
                self._kinds[item].model, self._kinds[item].integrator = vehicle.model, plant.integrator[0]
            rest.append(plant.c)
        return rest

    def _place(self) -> None:
        core, ffi = self.core, self.core.ffi
        self._items = items_of(core, f"laconic_{self._form}_state", self._states)
        given = ffi.from_buffer(f"laconic_{self._form}_input[]", self._inputs)
        self._pointers = (ffi.from_buffer("int32_t[]", self._kind_of), given,
                          ffi.from_buffer("int32_t[]", self.status), ffi.from_buffer("uint64_t[]", self.missed))
        kind_of, inputs, status, missed = self._pointers
        self.c = ffi.new("laconic_articulated_batch *", {
            "kinds": self._kinds, "kind_of": kind_of, "why": self._why, "status": status, "missed": missed,
            **dict(zip(TREES if self._slips else IDEAL, (self._items, inputs), strict=True))})
        self.status.flags.writeable = self.missed.flags.writeable = False

    # ---- copies

    def __getstate__(self) -> dict[str, Any]:
        """All but what holds addresses."""
        return {name: value for name, value in self.__dict__.items()
                if name not in ("_kinds", "_items", "_pointers", "c")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Places the same lanes in memory of their own."""
        self.__dict__.update(state)
        self._prepared(self.method)
        self.status.flags.writeable = self.missed.flags.writeable = True
        self._place()

    # ---- inputs

    def of(self, signal: str) -> np.ndarray:
        """A signal's input of all lanes, to be written in place: (numbers, lanes), or (lanes,) for one such as
        voltage_V[2] or hinge_torque_Nm[fork], whose hinge is found by its name in the first vehicle.

        A number that a lane's vehicle does not read has no effect."""
        most = max(self.vehicles, key=lambda vehicle: vehicle.body_count)
        slots = (most if isinstance(signal, str) and "[" not in signal else self.vehicles[0]).slots(signal)
        wheels = max(vehicle.wheel_count for vehicle in self.vehicles)
        name, _, inside = signal.partition("[")
        if name in OF_WHEELS and inside and int(inside.rstrip("]")) > wheels:
            raise BadInput(f"{signal}: there is no such wheel; give 1 to {wheels}")
        stop = slots.start + wheels if name in OF_WHEELS and not inside else slots.stop
        view = self._inputs[:, slots.start : stop].T
        return view[0] if inside else view

    def set(self, signal: str, value: Any) -> None:
        """Writes a signal of all lanes; BadInput for an array of another shape."""
        fill(signal, self.of(signal), value)

    # ---- motion

    def load(self, lane: int, state: Any) -> None:
        """Gives a lane a state such as `ArticulatedPlant.save()` has, of a vehicle like the lane's."""
        self._items[self._lane(lane)] = c_object(self.core, f"{self._form}_state", state)[0]

    def state(self, lane: int) -> Any:
        """A copy of a lane's state, all of it: `ArticulatedPlant.restore` takes it."""
        return self.core.ffi.new(f"laconic_{self._form}_state *", self._items[self._lane(lane)])

    def run(self, steps: int = 1, threads: int = 1) -> int:
        """Steps of all lanes with the inputs held, on so many threads; the bits do not depend on their number.

        A lane stops before a step that is refused, the others continue. Returns how many lanes were refused; `status`
        and `refusal` report which and why."""
        left, count = step_count("steps", steps), min(thread_count(threads), self.lane_count)
        at_once, refused = max(1, MOST_AT_ONCE // self.lane_count), -1
        while left or refused < 0:
            now = min(left, at_once)
            refused, left = self._run_parts(now, count), left - now
        return refused

    def _run_parts(self, steps: int, threads: int) -> int:
        run = self.core.lib.laconic_articulated_batch_run
        if threads == 1:
            return int(run(self.c, 0, self.lane_count, steps))
        edges = [self.lane_count * part // threads for part in range(threads + 1)]
        with ThreadPoolExecutor(threads, "laconic-batch") as pool:
            jobs = [pool.submit(run, self.c, first, end - first, steps)
                    for first, end in zip(edges, edges[1:], strict=False)]
        return sum(int(job.result()) for job in jobs)

    # ---- outputs

    @property
    def motion(self) -> np.ndarray:
        """The present motion of all lanes, shape (lanes,): a structured array with the names of ArticulatedMotion.

        Arrays of hinges and wheels have the core's largest number of them; a lane's own come first, the rest is 0."""
        found = items_of(self.core, "laconic_articulated_motion", self._motions)
        self.core.lib.laconic_articulated_batch_observe(self.c, 0, self.lane_count, found)
        return self._motions.copy()

    @property
    def outputs(self) -> np.ndarray:
        """All outputs of all lanes, which are on ground with friction: the same with the names of SlippingOutputs."""
        if not self._slips:
            raise BadInput("outputs: are of ground with friction, and this batch is on ideal ground; read motion, or "
                           "give vehicles with ground.friction_coefficient (laconic.SlippingVehicle)")
        found = zeros(self.core, "laconic_tree_outputs", self.lane_count)
        self.core.lib.laconic_articulated_batch_outputs(self.c, 0, self.lane_count,
                                                        items_of(self.core, "laconic_tree_outputs", found))
        return found

    def refusal(self, lane: int) -> Refused | None:
        """Why a lane's last run was refused, as an exception that names the lane; None where it was not."""
        if self.status[self._lane(lane)] == self.core.lib.LACONIC_OK:
            return None
        found = self.core.refusal(self._why + lane)
        return _named(f"lane {lane}", by_signal(found, self.vehicles[self._kind_of[lane]].names))

    def _lane(self, lane: int) -> int:
        found = whole_number("lane", lane)
        if not 0 <= found < self.lane_count:
            raise BadInput(f"lane: there is no {shown(lane)}; this batch has the lanes 0 to {self.lane_count - 1}")
        return found


def _slip(vehicles: Sequence[ArticulatedVehicle]) -> bool:
    """Whether these are on ground with friction; BadInput where some are and some are not."""
    slip = [isinstance(vehicle, SlippingVehicle) for vehicle in vehicles]
    for item, each in enumerate(slip, 1):
        if each != slip[0]:
            raise BadInput(f"vehicles[{item}]: is on {GROUND[each]}, and the first on {GROUND[slip[0]]}; make one "
                           "batch for each ground")
    return slip[0]


def _named(who: str, refused: Refused) -> Refused:
    return Refused(refused.status, refused.field, refused.item, f"{who}: {refused.message}", value=refused.value,
                   limit=refused.limit)
