"""Latency of answers: figures over all exchanges of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def latency_figures(seconds: Sequence[float]) -> dict[str, float]:
    """Round trips in microseconds: least, median, 99th percentile, worst, and jitter (standard deviation)."""
    if not len(seconds):
        return {}
    micro = 1e6 * np.asarray(seconds, float)
    return {
        "latency_min_us": float(micro.min()), "latency_median_us": float(np.median(micro)),
        "latency_p99_us": float(np.percentile(micro, 99)), "latency_max_us": float(micro.max()),
        "latency_jitter_us": float(micro.std())}


def period_figures(instants_s: Sequence[float], period_s: float) -> dict[str, float]:
    """Deviation of the intervals between cyclic frames from their period, in microseconds."""
    if len(instants_s) < 2:
        return {}
    off = 1e6 * (np.diff(np.asarray(instants_s, float)) - period_s)
    return {"period_us": 1e6 * period_s, "period_jitter_us": float(off.std()), "period_late_max_us": float(off.max())}
