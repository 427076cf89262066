"""The core's own lists of fields (vehicle.h, sensors.h): names in FMUs, scenes and on the wire, when each must come.

    for field in load("double").fields_of("vehicle.payload"):
        field.key, field.need, field.values(vehicle)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

COUNTED = ("wheel", "support")  # tables of which there are several; the field of that name counts them
ITEM = "[#]"
WHEEL = "vehicle.wheel[#]"
OWN = "own_"
GROUND, GROUND_OF = "ground", "vehicle.ground"  # a table of scenes, and where the core has it
OF_GROUND = ("friction_coefficient", "roller_drag", "axle_friction_Nm")  # that a wheel may have of its own

ABOVE_0 = {"radius_m": "the vehicle's wheel_radius_m", "friction_coefficient": "the ground's"}
"""What a wheel's own value cannot be 0 of, and whose value it has without one of its own."""


@dataclass(frozen=True)
class Field:
    """One row of the list; kind, rule and need are the ends of LACONIC_KIND_…, LACONIC_RULE_… and LACONIC_NEED_….

    Names are worked out once, as every vehicle that is made asks for them.
    """

    number: int      # on the wire
    identifier: str  # "WHEEL_X", as in the value table of PARAMETER.field
    name: str        # "wheel_x_m", of the FMI variable
    path: str        # "vehicle.wheel[#].x_m", in a scene
    kind: str
    rule: str
    need: str
    items: int       # how many numbers there may be; 0: the field is no list

    @cached_property
    def table(self) -> str:
        """"vehicle.wheel[#]"; empty for inputs."""
        return self.path.rpartition(".")[0]

    @cached_property
    def key(self) -> str:
        """"x_m"; of what a wheel may lack the name of its presence, "driven"."""
        key = self.path.rpartition(".")[2].removesuffix(ITEM)
        return key.removeprefix("un") if self.kind == "ABSENCE" else key

    @cached_property
    def struct(self) -> str:
        """The table as the core nests its structs: the ground is the vehicle's."""
        return GROUND_OF if self.table == GROUND else self.table

    @cached_property
    def root(self) -> str:
        """"vehicle", "initial", "run": the struct that holds it all."""
        return self.struct.partition(".")[0]

    @cached_property
    def is_own(self) -> bool:
        """Whether it is a wheel's own value, which is 0 where the vehicle's holds."""
        return self.table == WHEEL and self.name.startswith(OWN)

    @cached_property
    def member(self) -> str:
        """"x_m", "own_radius_m", "undriven": in the struct."""
        return self.name if self.is_own else self.path.rpartition(".")[2].removesuffix(ITEM)

    @property
    def vehicle_key(self) -> str:
        """Of a wheel's own value the vehicle's, or its ground's, that it stands for."""
        return f"wheel_{self.key}" if self.key in ("radius_m", "inertia_kgm2") else self.key

    @property
    def counts(self) -> bool:
        """Whether it counts tables, so that no scene has it as a key."""
        return self.table == "vehicle" and self.key in COUNTED

    def values(self, root: Any) -> list[float]:
        """Its numbers in a laconic_vehicle or laconic_start: of all items that there is room for."""
        if self.counts:
            return [int(getattr(root, f"{self.key}_count"))]
        structs = [root]
        for name in self.struct.split(".")[1:]:
            inner = getattr(root, name.removesuffix(ITEM))
            structs = list(inner) if name.endswith(ITEM) else [inner]
        found = [getattr(struct, self.member) for struct in structs]
        if self.path.endswith(ITEM):
            found = list(found[0])
        return [float(each) if self.kind == "REAL" else int(each) for each in found]


def fields_from(ffi: Any, lib: Any, of: str = "") -> tuple[Field, ...]:
    """Every field of a vehicle, its start and its inputs, in the order of the numbers; `of`: "sensor_", those of its
    sensors."""
    found = []
    for label, number in ffi.typeof(f"laconic_{of}field").relements.items():
        traits = lib.laconic_field_traits_of(number)
        if traits != ffi.NULL:
            spelled = (lib.laconic_field_name(number), lib.laconic_field_path(number))
            name, path = (ffi.string(text).decode() for text in spelled)
            kind, rule, need = (_end(ffi, traits, what) for what in ("kind", "rule", "need"))
            identifier, items = label.removeprefix(f"LACONIC_{of.upper()}FIELD_"), int(traits.items)
            found.append(Field(number, identifier, name, path, kind, rule, need, items))
    return tuple(sorted(found, key=lambda field: field.number))


def _end(ffi: Any, traits: Any, what: str) -> str:
    """The enumerator's name without what all of its kind begin with."""
    return ffi.typeof(f"laconic_field_{what}").elements[getattr(traits, what)].removeprefix(f"LACONIC_{what.upper()}_")


def set_own_zeros(vehicle: Any, wheels: Sequence[Mapping[str, Any]], fields: Sequence[Field]) -> None:
    """Lets a wheel's own 0 hold in a laconic_vehicle, where 0 means the vehicle's value.

    Where a wheel of `wheels` gives 0 and the vehicle's value is another, the vehicle's becomes 0 and all other wheels
    get it as their own.
    """
    for field in fields:
        if field.key in ABOVE_0:
            continue
        owner = vehicle.ground if field.key in OF_GROUND else vehicle
        common = getattr(owner, field.vehicle_key)
        given = [(target, field.key in wheel) for target, wheel in zip(vehicle.wheel, wheels, strict=False)]
        has_zero = any(is_given and getattr(target, field.member) == 0 for target, is_given in given)
        if not has_zero or common == 0 or (field.rule == "NOT_NEGATIVE" and not common > 0):  # the core refuses it
            continue
        for target, is_given in given:
            if not is_given:
                setattr(target, field.member, common)
        setattr(owner, field.vehicle_key, 0.0)
