"""The Python interface: `laconic.__all__`, by its docstrings."""

from __future__ import annotations

import inspect

import laconic


def python_page() -> str:
    """Directives for Sphinx's autodoc, in the order of `laconic.__all__`."""
    parts = ["# Python reference", "The public interface, `laconic.__all__`. [From Python](python.md) shows it at "
                                   "work."]
    for name in laconic.__all__:
        value = getattr(laconic, name)
        if isinstance(value, tuple):
            parts.append(f"## {name}\n\n" + ", ".join(f"`{each}`" for each in value))
            continue
        kind = "autoexception" if inspect.isclass(value) and issubclass(value, Exception) else \
            "autoclass" if inspect.isclass(value) else "autofunction"
        members = "\n   :members:" if kind in ("autoclass", "autoexception") else ""
        parts.append(f"## {name}\n\n```{{eval-rst}}\n.. {kind}:: laconic.{name}{members}\n```")
    return "\n\n".join(parts) + "\n"
