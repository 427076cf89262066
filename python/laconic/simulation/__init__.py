"""Runs of scenes through the core, and their signals over time."""

from laconic.simulation.run import (
    RunRefused,
    Trajectory,
    Watch,
    advance_plant,
    input_signals,
    run_window,
    simulate,
    usual_signals,
    wanted_signals,
)

__all__ = ["RunRefused", "Trajectory", "Watch", "advance_plant", "input_signals", "run_window", "simulate",
           "usual_signals", "wanted_signals"]
