"""A batch after os.fork(): the threads stayed with the parent, so the child begins new ones."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

import laconic

pytestmark = [pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork"),
              pytest.mark.filterwarnings("ignore:.*fork")]
LONGEST_S = 60


def test_a_batch_runs_on_threads_in_a_child_and_in_its_parent() -> None:
    batch = laconic.Batch(laconic.Vehicle.of(laconic.read_scene("robotino2")), 256, step_s=0.01)
    batch.voltage_V[:] = np.linspace(-6.0, 6.0, 256)
    batch.run(10, threads=2)
    reader, writer = os.pipe()
    if (child := os.fork()) == 0:
        signal.alarm(LONGEST_S)  # a child that waits for ever fails the test
        try:
            batch.run(10, threads=2)
            batch.run(10, threads=2)
            os.write(writer, batch.x_m.tobytes())
        finally:
            os._exit(0)
    os.close(writer)
    batch.run(20, threads=2)
    with os.fdopen(reader, "rb") as pipe:
        found = np.frombuffer(pipe.read())
    assert os.waitpid(child, 0)[1] == 0
    assert found.tolist() == batch.x_m.tolist()
