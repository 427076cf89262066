"""The page of a sweep: what was varied, what came out, and how much each key has to do with it.

How much each varied key has to do with a measure, by SALib.

With Saltelli's design Sobol' indices: the share of the measure's variance that a key brings alone (first order) and
with all others (total). Otherwise PAWN from the runs as they are: how far the measure's distribution moves when the key
is held in a tenth of its range (0: not at all, 1: to where it never was), with first-order indices by RBD-FAST.
"""

from __future__ import annotations

import base64
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files

import numpy as np
import pyarrow.parquet as pq

from laconic.base.outputs import write_text
from laconic.errors import ResultFails
from laconic.pictures.sweep_panels import bars, effect, histogram
from laconic.tools.sweep.plan import Plan, problem_of
from laconic.tools.sweep.store import RESULTS, Store

MOST_RUNS = 20000  # from which PAWN and RBD-FAST estimate, drawn evenly
SLICES = 10
FEWEST_RUNS = 100


@dataclass(frozen=True)
class Indices:
    """Of one measure: by key, each with its half interval of 95 %."""

    method: str
    name: str                                     # of the index: "total", "PAWN"
    index: Mapping[str, tuple[float, float]]
    first_order: Mapping[str, tuple[float, float]]


def indices_of(plan: Plan, columns: Mapping[str, np.ndarray], measure: np.ndarray) -> Indices | None:
    """Indices of the keys that are numbers; None where the runs do not tell: too few, or nothing varies."""
    if plan.is_saltelli and np.isfinite(measure).all() and np.ptp(measure) > 0:
        return _sobol(plan, measure)
    keys = [each.key.text for each in plan.varied if columns[each.key.text].dtype.kind == "f"
            and np.ptp(columns[each.key.text]) > 0]
    good = np.flatnonzero(np.isfinite(measure))
    if not keys or len(good) < FEWEST_RUNS or np.ptp(measure[good]) <= 0:
        return None
    few = np.random.default_rng(1).permutation(good)[:MOST_RUNS]  # a grid's order would correlate its keys
    return _as_given(keys, np.column_stack([columns[key][few] for key in keys]), measure[few])


def _sobol(plan: Plan, measure: np.ndarray) -> Indices:
    from SALib.analyze import sobol
    keys = [each.key.text for each in plan.varied]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = sobol.analyze(problem_of(keys), measure, calc_second_order=False, seed=1, num_resamples=100)
    return Indices("Sobol' indices from Saltelli's design", "total", _pairs(keys, found, "ST", "ST_conf"),
                   _pairs(keys, found, "S1", "S1_conf"))


def _as_given(keys: list[str], values: np.ndarray, measure: np.ndarray) -> Indices:
    from SALib.analyze import pawn, rbd_fast
    problem = {"num_vars": len(keys), "names": keys,
               "bounds": [[float(column.min()), float(column.max())] for column in values.T]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        moved = pawn.analyze(problem, values, measure, S=SLICES, seed=1)
        alone = rbd_fast.analyze(problem, values, measure, num_resamples=50, seed=1)
    return Indices(f"PAWN (median of {SLICES} slices, ± their standard deviation) and first-order indices by RBD-FAST, "
                   f"from {len(measure)} runs as they are", "PAWN", _pairs(keys, moved, "median", "stdev"),
                   _pairs(keys, alone, "S1", "S1_conf"))


def _pairs(keys: list[str], found: Mapping[str, np.ndarray], index: str, half: str) -> dict[str, tuple[float, float]]:
    return {key: (float(value), float(width)) for key, value, width in
            zip(keys, found[index], found[half], strict=True)}


PAGE = "summary.html"
MOST_KEYS = 8      # with a panel for each measure
MOST_REASONS = 10
STATISTICS = ("mean", "standard deviation", "least", "5 %", "median", "95 %", "greatest")


def write_page(store: Store) -> list[str]:
    """Writes summary.html; returns what the command says in the end."""
    columns = _columns(store)
    refused = np.array([reason is not None for reason in columns["refused"]])
    body = [_lead(store, columns, refused)]
    for measure in store.plan.measures:
        body += _of_measure(store, measure.text, measure.words, columns)
    template = files("laconic.tools.sweep").joinpath("page.html").read_text(encoding="utf-8")
    title = f"Sweep of {store.plan.scene}"
    write_text(store.folder / PAGE, template.replace("{{title}}", escape(title)).replace("{{body}}", "\n".join(body)))
    told = [f"{store.plan.runs} runs, {int(refused.sum())} of them refused"]
    return [*told, f"wrote {store.folder / RESULTS}", f"wrote {store.folder / PAGE}"]


def check_any_run(store: Store) -> None:
    """ResultFails where every run was refused."""
    refused = pq.read_table(store.folder / RESULTS, columns=["refused"])["refused"]
    if refused.null_count == 0:
        raise ResultFails(f"every run was refused, the first because {refused[0].as_py()}; {store.folder / RESULTS} "
                          "has them all")


def _columns(store: Store) -> dict[str, np.ndarray]:
    """Columns of the results as arrays; numbers that are not there as NaN."""
    table = pq.read_table(store.folder / RESULTS)
    return {name: np.asarray(table[name].to_numpy(zero_copy_only=False)) for name in table.column_names}


def _lead(store: Store, columns: Mapping[str, np.ndarray], refused: np.ndarray) -> str:
    plan = store.plan
    versions = ", ".join(f"{name} {number}" for name, number in store.about["versions"].items())
    parts = [f"<p>{plan.runs} runs; {int(refused.sum())} of them were refused. Made by</p>",
             f"<pre>{escape(str(store.about['command']))}</pre>",
             f'<p class="soft">{escape(versions)}. <code>laconic sweep -o DIR --repeat RUN</code> writes the scene of '
             "one run. Where a run has no value, its cell of the results is empty; <code>refused</code> says why.</p>"]
    if refused.any():
        reasons, counts = np.unique(columns["refused"][refused].astype(str), return_counts=True)
        order = np.argsort(-counts, kind="stable")[:MOST_REASONS]
        parts.append(_table(["refused because", "runs"], [[reasons[k], str(counts[k])] for k in order]))
        if len(reasons) > MOST_REASONS:
            more = len(reasons) - MOST_REASONS
            parts.append(f'<p class="soft">and {more} other reasons, which the results name.</p>')
    return "\n".join(parts)


def _of_measure(store: Store, name: str, words: str, columns: Mapping[str, np.ndarray]) -> list[str]:
    """One measure: statistics, histogram, effects, indices."""
    values = columns[name].astype(float)
    good = np.isfinite(values)
    parts = [f'<h2 id="{escape(name)}">{escape(name)}</h2>', f"<p>{escape(words)}.</p>"]
    if not good.any():
        return [*parts, "<p>No run has a value.</p>"]
    found = values[good]
    parts.append(_table([*STATISTICS, "runs without"], [[f"{each:.6g}" for each in _statistics(found)]
                                                        + [str(int((~good).sum()))]]))
    indices = indices_of(store.plan, columns, values)
    keys = [each.key.text for each in store.plan.varied]
    if indices:
        keys.sort(key=lambda key: -indices.index.get(key, (0.0, 0.0))[0])
    panels = [histogram(name, found), *(effect(key, columns[key][good], name, found) for key in keys[:MOST_KEYS])]
    captions = ["How often which values come", *(f"By {key}: mean and the middle 90 %" for key in keys[:MOST_KEYS])]
    if indices:
        panels.append(bars(name, indices.index, indices.first_order, indices.name))
        captions.append(indices.method)
    parts.append(_grid(panels, captions))
    if len(keys) > MOST_KEYS:
        parts.append(f'<p class="soft">The other {len(keys) - MOST_KEYS} keys have less to do with it.</p>')
    return parts + ([_indices_table(indices)] if indices else
                    ['<p class="soft">Too few runs, or nothing that varies: no sensitivity indices.</p>'])


def _statistics(found: np.ndarray) -> list[float]:
    return [found.mean(), found.std(), found.min(), *np.quantile(found, [0.05, 0.5, 0.95]), found.max()]


def _indices_table(indices: Indices) -> str:
    rows = [[key, *(f"{value:.3f} ± {half:.3f}" for value, half in (indices.index[key], indices.first_order[key]))]
            for key in sorted(indices.index, key=lambda key: -indices.index[key][0])]
    return _table(["key", indices.name, "first order"], rows)


def _table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(title)}</th>" for title in titles)
    body = "".join("<tr>" + "".join(f'<td data-title="{escape(title)}">{escape(cell)}</td>'
                                    for title, cell in zip(titles, row, strict=True)) + "</tr>" for row in rows)
    return f'<div class="table"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _grid(panels: Sequence[str], captions: Sequence[str]) -> str:
    figures = []
    for panel, caption in zip(panels, captions, strict=True):
        source = base64.b64encode(panel.encode()).decode()
        figures.append(f'<figure><img alt="{escape(caption)}" src="data:image/svg+xml;base64,{source}">'
                       f"<figcaption>{escape(caption)}</figcaption></figure>")
    return f'<div class="grid">{"".join(figures)}</div>'
