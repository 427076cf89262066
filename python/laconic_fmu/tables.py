"""The C tables: one row per variable, start values, tokens."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import accumulate

from .description import Description, Variable, start_values, token_in
from .for_vehicle import for_vehicle
from .friction import STATE_RATE

TYPES = {"Float64": "FMU_REAL", "Int32": "FMU_INT32", "UInt64": "FMU_UINT64", "Enumeration": "FMU_ENUMERATION",
         "Boolean": "FMU_BOOLEAN", "Binary": "FMU_BINARY", "Clock": "FMU_CLOCK"}


def _access(variable: Variable, states: Mapping[str, str]) -> str:
    if str(variable.reference) in states:
        return "FMU_OPTIONAL_STATE" if states[str(variable.reference)] == STATE_RATE else "FMU_STATE"
    if variable.causality == "parameter":
        return "FMU_TUNABLE" if variable.attributes.get("variability") == "tunable" else "FMU_FIXED"
    return {"independent": "FMU_INDEPENDENT", "structuralParameter": "FMU_STRUCTURAL", "input": "FMU_INPUT",
            "output": "FMU_OUTPUT"}.get(variable.causality, "FMU_LOCAL")


def _range(description: Description, variable: Variable) -> str:
    """Least and largest value of the variable, from the description or else its type."""
    whole = {"Float64": ("-DBL_MAX", "DBL_MAX"), "Int32": ("INT32_MIN", "INT32_MAX"), "Boolean": ("0", "1"),
             "Binary": ("0", "0"), "Clock": ("0", "0")}
    least, most = whole.get(variable.tag, ("", ""))
    if variable.tag == "Enumeration":
        items = description.items(variable)
        least, most = str(min(items)), str(max(items))
    return f"{variable.attributes.get('min', least)}, {variable.attributes.get('max', most)}"


def _size(description: Description, variable: Variable) -> int | str:
    """As fmu_variable.size has it."""
    if variable.size is None or isinstance(variable.size, int):
        return variable.size or 1
    first = description.array_parameter
    return 0 if first is not None and variable.size == first.name else "FMU_OTHER_SIZE"


def _row(description: Description, variable: Variable, name_at: int, states: Mapping[str, str]) -> str:
    symbol = re.sub(r"\W+", "_", variable.name).strip("_")
    size = _size(description, variable)
    return (f"    ROW({symbol}, {name_at}, {size}, {TYPES[variable.tag]}, {_access(variable, states)}, "
            f"{variable.attributes.get('intermediateUpdate', 'false')}, {_range(description, variable)}),")


def _fits(description: Description) -> list[str]:
    """C that does not compile if the description declares longer arrays than the model has."""
    largest = ("FMU_MODEL_LARGEST_ARRAY", "FMU_MODEL_OTHER_LARGEST_ARRAY")
    fits = [f"typedef char fmu_{parameter.name}_fits[{parameter.attributes['max']} <= {most} ? 1 : -1];"
            for parameter, most in zip(description.array_parameters, largest, strict=False)]
    return [*fits, ""] if fits else []


def tables(description: Description, text_3: str, text_2: str) -> str:
    """The C file that fmu/glue/variables.c and fmu/glue/start_file.c link with."""
    starts = start_values(for_vehicle(description))
    states = {v.attributes["derivative"]: v.name for v in description.variables if "derivative" in v.attributes}
    name_at = list(accumulate((len(v.name) + 1 for v in description.variables), initial=0))
    lines = [
        "/* Made from the model description when the project is built. */",
        "#include <float.h>",
        "",
        '#include "instance.h"',
        '#include "variable_locations.h"',
        "",
        "#define ROW(symbol, name, size, type, access, intermediate, least, most) \\",
        "    {FMU_OFFSET_##symbol, name, (uint16_t)FMU_STRIDE_##symbol, size, type, access, intermediate, least, \\",
        "     most, FMU_GROUP_OF_##symbol, (uint32_t)FMU_TANGENT_##symbol}",
        "",
        *_fits(description),
        "",
        "const fmu_variable fmu_variables[] = {",
        *(_row(description, v, at, states) for v, at in zip(description.variables, name_at, strict=False)),
        "};",
        "const char fmu_variable_names[] =",
        *(f'    "{variable.name}\\0"' for variable in description.variables), "    ;",
        f"const uint32_t fmu_variable_count = {len(description.variables)}U;",
        "",
        "const fmu_start_value fmu_built_in_starts[] = {",
        *(f"    {{{reference}U, {value!r}}}," for reference, value in starts),
        "};",
        f"const size_t fmu_built_in_start_count = {len(starts)}U;",
        "",
        f'const char *const fmu_token_2 = "{token_in(text_2)}";',
        f'const char *const fmu_token_3 = "{token_in(text_3)}";',
        "",
    ]
    return "\n".join(lines)
