"""A progress bar on stderr for work that takes long; silent where nobody watches."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

Advance = Callable[..., None]


@contextmanager
def progress_bar(what: str, total: float) -> Iterator[Advance]:
    """Yields advance(amount=1, what=None): moves the bar on, and may rename what it says."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda amount=1, what=None: None
        return
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)

        def advance(amount: float = 1, what: str | None = None) -> None:
            bar.update(task, advance=amount, **({"description": what} if what else {}))

        yield advance
