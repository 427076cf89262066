"""Models inside an SDF model: their links, joints and frames become those of the model around them.

As in SDFormat their names begin with the inner model's name and "::"; what is relative to nothing in the inner model is
relative to its frame.

The tree in the links and joints of an SDF model, which may have loops and links that nothing holds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from laconic.errors import BadInput
from laconic.robot.importer.gravity import listed
from laconic.robot.importer.meshes import MeshFiles
from laconic.robot.importer.xml_file import Element, bytes_of, root_of

OWN = "__model__"
BETWEEN_SCHEME = "://"
OLD_AXES = ("1.0", "1.1", "1.2", "1.3", "1.4")  # versions in which axes are in the frame of the model
DEEPEST = 20  # models inside models
BETWEEN = "::"
OUTSIDE = ("world", "__root__")
PARTS = ("link", "joint", "frame")
ENDS = ("parent", "child", "gearbox_reference_body")
REFERENCES = ("relative_to", "attached_to", "expressed_in")


def take_includes(path: Path, element: Element, files: MeshFiles, depth: int = 1) -> None:
    """Puts the models of files that are near in the place of their <include>, at any depth; others stay."""
    for at, child in enumerate(list(element)):
        if child.tag == "include" and (model := _included(child, files)) is not None:
            if depth > DEEPEST:
                raise BadInput(f"{path}: includes models that include models, {depth} deep; more than {DEEPEST} are "
                               "not read")
            element[at] = child = model
        if child.tag == "model" and depth <= DEEPEST:
            take_includes(path, child, files, depth + 1)


def _included(include: Element, files: MeshFiles) -> Element | None:
    """The model of a file, with the name and pose that it is included with; None where it cannot be had."""
    file = _file_of((include.findtext("uri") or "").strip(), files)
    if file is None or include.find("placement_frame") is not None or include.get("merge") in ("1", "true"):
        return None
    root = root_of(file, bytes_of(file), "is no XML")
    model = root.find("model")
    if root.tag != "sdf" or model is None or (root.get("version", "1.9") in OLD_AXES and model.find(".//joint/axis")
                                              is not None):
        return None
    for each in (*model.iter("uri"), *model.iter("filename")):
        text = (each.text or "").strip()
        if text and BETWEEN_SCHEME not in text and not Path(text).is_absolute():
            each.text = str(file.parent.resolve() / text)
    for tag in ("pose", "static"):
        if (given := include.find(tag)) is not None:
            for own in model.findall(tag):
                model.remove(own)
            model.append(given)
    if name := (include.findtext("name") or "").strip():
        model.set("name", name)
    return model


def _file_of(uri: str, files: MeshFiles) -> Path | None:
    """The SDF file of an include: itself, or that which the folder of a Gazebo model names."""
    found = files.find(uri) if uri else None
    if found is not None and found.is_dir():
        config = found / "model.config"
        named = [(each.text or "").strip() for each in root_of(config, bytes_of(config), "is no XML").iter("sdf")
                 ] if config.is_file() and not files.outside(config) else []
        there = [found / name for name in (*named[::-1], "model.sdf") if name and (found / name).is_file()]
        found = next(iter(there), None)
    if found is None or found.suffix.lower() not in (".sdf", ".world") or files.outside(found):
        return None
    return found


def flatten(path: Path, model: Element, depth: int = 1) -> None:
    """Takes the parts of models inside into the model itself."""
    inside = model.findall("model")
    if inside and depth > DEEPEST:
        raise BadInput(f"{path}: has models inside models, {depth} deep; more than {DEEPEST} are not read")
    for inner in inside:
        flatten(path, inner, depth + 1)
        model.remove(inner)
        names = {each.get("name") for each in model if each.tag in PARTS}
        model.extend(list(_parts(path, inner)))
        if inner.get("name") not in names:
            model.append(_frame(inner.get("name", ""), {"attached_to": f"{inner.get('name')}{BETWEEN}{OWN}"}))


def _parts(path: Path, inner: Element) -> Iterator[Element]:
    """Of a model without models inside, renamed for the model around it."""
    name = inner.get("name")
    if not name:
        raise BadInput(f"{path}: a <model> inside another has no name; give one")
    if inner.get("placement_frame"):
        raise BadInput(f"{path}: model {name} has a placement_frame, which is not read; give the pose of its own frame")
    joints = {each.get("name", "") for each in inner.findall("joint")}
    own = _frame(f"{name}{BETWEEN}{OWN}")
    own.extend(inner.findall("pose"))
    yield own
    for part in inner:
        if part.tag in (*PARTS, "plugin", "include"):
            _rename(part, name, joints)
            yield part


def _frame(name: str, attributes: dict[str, str] | None = None) -> Element:
    return ElementTree.Element("frame", {"name": name, **(attributes or {})})


def _rename(part: Element, model: str, joints: set[str]) -> None:
    """Every name of the inner model in a part of it."""
    def full(name: str) -> str:
        return name if name in OUTSIDE else f"{model}{BETWEEN}{name}"

    if part.tag == "plugin":  # which names joints in texts
        for each in part.iter():
            each.text = " ".join(full(word) if word in joints else word for word in (each.text or "").split())
        return
    if part.tag in PARTS and part.get("name"):
        part.set("name", full(part.get("name", "")))
    for each in part.iter():
        for key in REFERENCES:
            if each.get(key):
                each.set(key, full(each.get(key, "")))
        if each.tag in ENDS and (each.text or "").strip():
            each.text = full((each.text or "").strip())
        if each.tag == "mimic" and each.get("joint"):
            each.set("joint", full(each.get("joint", "")))
    if part.tag in ("link", "frame"):
        _place(part, f"{model}{BETWEEN}{OWN}")


def _place(part: Element, frame: str) -> None:
    """Relative to the inner model, unless it is relative to something in it."""
    pose = part.find("pose")
    if pose is None:
        pose = ElementTree.SubElement(part, "pose")
    if not pose.get("relative_to") and not (part.tag == "frame" and part.get("attached_to")):
        pose.set("relative_to", frame)


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
