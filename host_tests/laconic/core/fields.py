"""The core's own list of fields (vehicle.h): what each is called in FMUs, scenes and on the wire, when it must come.

    for field in load("double").fields_of("vehicle.payload"):
        field.key, field.need, field.values(vehicle)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

COUNTED = ("wheel", "support")  # tables of which there are several; the field of that name counts them
ITEM = "[#]"


@dataclass(frozen=True)
class Field:
    """One row of the list; kind, rule and need are the ends of LACONIC_KIND_…, LACONIC_RULE_… and LACONIC_NEED_…."""

    number: int      # on the wire
    identifier: str  # "WHEEL_X", as in the value table of PARAMETER.field
    name: str        # "wheel_x_m", of the FMI variable
    path: str        # "vehicle.wheel[#].x_m", in a scene
    kind: str
    rule: str
    need: str
    items: int       # how many numbers there may be; 0: the field is no list

    @property
    def table(self) -> str:
        """"vehicle.wheel[#]"; empty for inputs."""
        return self.path.rpartition(".")[0]

    @property
    def key(self) -> str:
        """"x_m"."""
        return self.path.rpartition(".")[2].removesuffix(ITEM)

    @property
    def counts(self) -> bool:
        """Whether it counts tables, so that no scene has it as a key."""
        return self.table == "vehicle" and self.key in COUNTED

    def values(self, root: Any) -> list[float]:
        """Its numbers in a laconic_vehicle or laconic_start: of all items that there is room for."""
        if self.counts:
            return [int(getattr(root, f"{self.key}_count"))]
        structs = [root]
        for name in self.table.split(".")[1:]:
            inner = getattr(root, name.removesuffix(ITEM))
            structs = list(inner) if name.endswith(ITEM) else [inner]
        found = [getattr(struct, self.key) for struct in structs]
        if self.path.endswith(ITEM):
            found = list(found[0])
        return [float(each) if self.kind == "REAL" else int(each) for each in found]


def fields_from(ffi: Any, lib: Any) -> tuple[Field, ...]:
    """Every field, in the order of the numbers."""
    found = []
    for label, number in ffi.typeof("laconic_field").relements.items():
        traits = lib.laconic_field_traits_of(number)
        if traits != ffi.NULL:
            spelled = (lib.laconic_field_name(number), lib.laconic_field_path(number))
            name, path = (ffi.string(text).decode() for text in spelled)
            kind, rule, need = (_end(ffi, traits, what) for what in ("kind", "rule", "need"))
            identifier, items = label.removeprefix("LACONIC_FIELD_"), int(traits.items)
            found.append(Field(number, identifier, name, path, kind, rule, need, items))
    return tuple(sorted(found, key=lambda field: field.number))


def _end(ffi: Any, traits: Any, what: str) -> str:
    """The enumerator's name without what all of its kind begin with."""
    return ffi.typeof(f"laconic_field_{what}").elements[getattr(traits, what)].removeprefix(f"LACONIC_{what.upper()}_")
