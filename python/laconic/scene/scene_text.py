"""A scene as TOML text: values with all their digits, a comment behind each that has one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

Comments = dict[tuple[str, ...], str]
"""By location: ("vehicle", "wheel", "0", "x_m")."""


def lines_of(table: Mapping[str, Any], comments: Comments, location: tuple[str, ...] = ()) -> Iterator[str]:
    """A table's own keys, then its tables."""
    inner = {key: value for key, value in table.items() if _is_table(value) or _is_tables(value)}
    for key, value in table.items():
        if key not in inner:
            comment = comments.get((*location, key), "")
            yield f"{key} = {value_text(value)}" + (f"  # {comment}" if comment else "")
    for key, value in inner.items():
        name = ".".join(part for part in (*location, key) if not part.isdigit())
        for number, each in enumerate(value if _is_tables(value) else [value]):
            yield ""
            yield f"[[{name}]]" if _is_tables(value) else f"[{name}]"
            deeper = (*location, key, str(number)) if _is_tables(value) else (*location, key)
            yield from lines_of(each, comments, deeper)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(each, dict) for each in value)


def value_text(value: Any) -> str:
    """One value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = "".join(c if c >= " " and c not in '"\\\x7f' else f"\\u{ord(c):04x}" for c in value)
        return f'"{escaped}"'
    if isinstance(value, list):
        return f"[{', '.join(value_text(each) for each in value)}]"
    return repr(value) if isinstance(value, (int, float)) else str(value)
