"""What holds for every test of the host."""

from __future__ import annotations

import random
import secrets

import pytest


@pytest.fixture(autouse=True)
def _seeded_session_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """A frame of an earlier session passes the next one's CRC of 8 bits once in 256 sessions: no test hangs on it."""
    monkeypatch.setattr(secrets, "randbits", random.Random(20111125).getrandbits)
