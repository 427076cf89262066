"""What a node tells of its error at the end of a run: all pages of one ERROR_ESTIMATE."""

from __future__ import annotations

from laconic.can.rig.client import NodeClient
from laconic.can.rig.wire import wire
from laconic.scene import Scene

FRAME = "ERROR_ESTIMATE"
UNITS = {"nu": "nu_rad_per_s", "place": "place_m", "heading": "heading_rad", "wheel_angle": "wheel_angle_rad"}
LARGEST = "largest_"
PAGES = 2 * len(UNITS)
ROUNDS = 5  # of its cycle, in which all pages of one instant must come


def is_estimated(scene: Scene) -> bool:
    """Whether the scene's [rig] frames ask for it."""
    return FRAME in scene.rig.frames


def read_estimate(node: NodeClient) -> dict[str, float]:
    """The figures by the names of `laconic simulate`, of an instant from now on; none where pages do not come in time.
    A node at rest goes on to send them."""
    frame, found = wire()[FRAME], dict[int, dict[str, float]]()
    deadline_us = node.link.deadline_us(ROUNDS * float(frame.attributes["GenMsgCycleTime"]) / 1e3)
    while len(found) < PAGES and (received := node.link.receive_until(deadline_us)) is not None:
        if received[0].name == FRAME:
            values = frame.physical(received[1])
            if values["page"] == 0:
                found.clear()
            if values["page"] == len(found):  # the next of the same instant
                found[len(found)] = values
    return figures_of(found) if len(found) == PAGES else {}


def figures_of(pages: dict[int, dict[str, float]]) -> dict[str, float]:
    """Of all pages."""
    values = {name: value for page in pages.values() for name, value in page.items()}
    named = {f"{which}estimated_error_{unit}": values[which + name] for which in ("", LARGEST)
             for name, unit in UNITS.items()}
    return named | {"estimate_unknown_windows": values["unknown"]}
