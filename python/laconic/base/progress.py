"""A progress bar on stderr for work that takes long; without a terminal a line each minute."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Advance = Callable[..., None]
FIRST_WORD_S = 0.5  # after so long stderr states how long the work takes,
LONG_S = 60.0       # if that is longer than this


@contextmanager
def progress_bar(what: str, total: float, *, forecasts: bool = False) -> Iterator[Advance]:
    """Yields advance(amount=1, what=None): moves the bar on, and may rename it.

    Where stderr is no terminal, a line a minute states how far the work is; `forecasts`: one line how long it takes, if
    that is long.
    """
    if not (sys.stderr and sys.stderr.isatty()):
        yield forecast(what, total) if forecasts else each_minute(what, total)
        return
    from rich.console import Console  # here, as it would take a third of the start of every command
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)

        def advance(amount: float = 1, what: str | None = None) -> None:
            bar.update(task, advance=amount, description=what or None)

        yield advance


def forecast(what: str, total: float, clock: Callable[[], float] = time.monotonic) -> Advance:
    """An advance(amount) that states once, on stderr, how long long work takes."""
    began, done, stated = clock(), 0.0, False

    def advance(amount: float = 1, what_now: str | None = None) -> None:
        nonlocal done, stated
        done += amount
        elapsed_s = clock() - began
        if stated or done <= 0 or elapsed_s < FIRST_WORD_S:
            return
        stated, whole_s = True, elapsed_s * total / done
        if whole_s > LONG_S:
            print(f"laconic: {what_now or what}: takes about {duration_text(whole_s)}; Ctrl-C ends it",
                  file=sys.stderr, flush=True)

    return advance


def each_minute(task: str, total: float, clock: Callable[[], float] = time.monotonic) -> Advance:
    """An advance(amount, what) that states on stderr, at most once a minute, how far the work is."""
    began = last = clock()
    done, name = 0.0, task

    def advance(amount: float = 1, what: str | None = None) -> None:
        nonlocal last, done, name
        now, done, name = clock(), done + amount, f"{task}, {what}" if what else name
        if now - last >= LONG_S:
            last = now
            left = f", about {duration_text((now - began) * (total - done) / done)} left" if 0 < done < total else ""
            print(f"laconic: {name}: {done:.0f} of {total:.0f} after {duration_text(now - began)}{left}",
                  file=sys.stderr, flush=True)

    return advance


def duration_text(seconds: float) -> str:
    """A time for people, in its largest fitting unit."""
    units = (("years", 365.25 * 86400.0), ("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0), ("seconds", 1.0))
    name, size = next((unit for unit in units if seconds >= 2.0 * unit[1]), units[-1])
    return f"{seconds / size:.0f} {name}"
