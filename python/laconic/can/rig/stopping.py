"""Bringing a node to rest, however a run has ended, and finding one that runs."""

from __future__ import annotations

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import BusDied, CannotReach, NodeRefused, NodeSilent

ATTEMPTS = 4
PATIENCE_S = 0.25  # wait for one answer: a run that ends must not take long
RUNNING = ("lockstep", "free run", "timeout", "drives")


def come_to_rest(node: NodeClient) -> str | None:
    """Sends STOP until it is answered; returns None, or the last error where no answer came."""
    patience_s, node.timeout_s = node.timeout_s, min(node.timeout_s, PATIENCE_S)
    why = "no attempt was made"
    try:
        for _ in range(ATTEMPTS):
            try:
                node.stop()
                return None
            except (NodeSilent, NodeRefused) as error:  # a refusal may be the late answer to another frame
                why = str(error)
            except BusDied as error:
                return str(error)
    finally:
        node.timeout_s = patience_s
    return why


def stop_running(node: NodeClient) -> str:
    """Opens a session, which stops a node that runs; the state in which it was found. CannotReach when no
    node answers on the bus."""
    try:
        node.open()
    except (BusDied, NodeSilent, NodeRefused) as error:
        raise CannotReach(f"no node could be reached: {error}") from None
    return node.found


def stop_and_reset(node: NodeClient, with_reset: bool) -> dict[str, str]:
    """What --stop and --reset do: the states in which the node was found and left."""
    found = stop_running(node)
    if with_reset and node.state != "empty":  # without a vehicle there is no start to return to
        node.reset()
    return {"found": found, "state": node.state}
