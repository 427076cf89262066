"""Control with a step's derivatives: a Kalman filter, a predictive controller, a step for CasADi; docs/control.md."""

from __future__ import annotations
