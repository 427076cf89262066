"""The adjoint of a step beside its Jacobian and its tangents."""

from __future__ import annotations

import numpy as np

from laconic.core.derivatives import StepDerivatives
from laconic.core.plant import Plant
from laconic.tools.verify.exact.trials import INPUTS, Trial


def adjoint_error(random: np.random.Generator, trial: Trial, plant: Plant) -> float:
    """The larger of two errors along random directions: of each number of the adjoint beside its column of the
    Jacobian, and of its product with a direction beside the covector's product with the tangent.

    Both are relative to the sum of magnitudes that such a product adds up, of which its rounding is some units.
    """
    step = StepDerivatives(plant, trial.held)
    gradient, state = random.normal(size=(2, 6 + plant.wheel_count))
    held = {name: random.normal(size=len(values)).tolist() for name, values in trial.held.items()}
    direction = np.concatenate([state, *(held[name] for name in INPUTS)])
    jacobian = step.jacobian(world_force=True)
    matrix = np.hstack([jacobian.by_state, jacobian.by_input])
    size = np.abs(matrix).T @ np.abs(gradient)
    found = np.concatenate(step.adjoint(gradient))
    columns = np.divide(np.abs(found - matrix.T @ gradient), size, out=np.zeros_like(size), where=size > 0.0)
    product = abs(found @ direction - gradient @ step.tangent(state, held)) / (size @ np.abs(direction))
    return max(float(columns.max()), float(product))
