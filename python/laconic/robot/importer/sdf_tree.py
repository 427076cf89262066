"""The tree in the links and joints of an SDF model, which may have loops and links that nothing holds."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from laconic.robot.importer.gravity import listed

Ends = Mapping[str, tuple[str, str]]


@dataclass(frozen=True)
class Tree:
    """Its links, its joints with parent and child, and what was left out."""

    links: list[str]
    ends: dict[str, tuple[str, str]]
    remarks: list[str]


def tree_of(links: Collection[str], ends: Ends) -> Tree:
    """All of it where it is a tree, or where one joint names a link that is not there, which is refused elsewhere."""
    children = [child for _, child in ends.values()]
    roots = [link for link in links if link not in set(children)]
    known = all(end in links for pair in ends.values() for end in pair)
    if not known or not roots or (len(roots) == 1 and len(set(children)) == len(children)):
        return Tree([*links], dict(ends), [])
    kept = max((_grown(root, ends) for root in roots), key=lambda grown: len(grown[0]))
    reached, joints = kept
    loose = [link for link in links if link not in reached]
    closing = [name for name, (parent, _) in ends.items() if name not in joints and parent in reached]
    remarks = [f"joints that close a loop are left out: {listed(closing)}"] if closing else []
    if loose:
        remarks.append(f"links that are not joined to the others are left out, with their mass: {listed(loose)}")
    return Tree([link for link in links if link in reached], joints, remarks)


def _grown(root: str, ends: Ends) -> tuple[dict[str, None], dict[str, tuple[str, str]]]:
    """What hangs on a link, then what is joined to that the other way round."""
    by_link: dict[str, list[str]] = {}
    for name, pair in ends.items():
        for link in pair:
            by_link.setdefault(link, []).append(name)
    reached: dict[str, None] = {root: None}
    joints: dict[str, tuple[str, str]] = {}
    ahead, back = [root], [root]
    while ahead or back:
        forward = bool(ahead)
        link = ahead.pop() if forward else back.pop()
        for name in by_link.get(link, ()):
            parent, child = ends[name]
            other = child if parent == link else parent
            if other in reached or (forward and parent != link):
                continue
            reached[other] = None
            joints[name] = (link, other)
            ahead.append(other)
            back.append(other)
    return reached, joints
