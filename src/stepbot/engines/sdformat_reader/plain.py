"""An SDFormat model in plain form: without nested models, with joints between links and poses of shapes in their links.

http://sdformat.org/tutorials?tut=composition: the elements of a nested model are ``model::element`` outside of it.
"""

from collections.abc import Callable, Iterator

from ..xml import Element
from .frames import MODEL, WORLD, Frames, ends, read_pose

_NAMED = ("link", "joint", "frame")
_PLACED = ("visual", "collision")
_REFERENCES = ("relative_to", "attached_to", "expressed_in")


def plain(model: Element) -> Element:
    """The same model in plain form; it is changed.

    Raises:
        EngineRefused: A frame does not exist.
    """
    for nested in model.findall("model"):
        _dissolve(nested, model)
    _place_by_origin(model)
    _move_to_links(model)
    _add_world(model)
    return model


def join_links(model: Element) -> None:
    """State the links of joints between frames; a joint's pose is relative to its child, as the file names it.

    Raises:
        EngineRefused: A frame does not exist, or its definition is circular.
    """
    from lxml import etree

    frames = Frames(model)
    for joint in model.findall("joint"):
        for end in (*joint.findall("parent"), *joint.findall("child")):
            frame = (end.text or "").strip()
            link = frames.link_of(frame)
            if link != frame and end.tag == "child":
                pose = joint.find("pose")
                pose = etree.SubElement(joint, "pose") if pose is None else pose
                pose.set("relative_to", pose.get("relative_to") or frame)
            end.text = link


def _dissolve(nested: Element, into: Element) -> None:
    """Make the elements of a nested model those of the model around it."""
    from lxml import etree

    for inner in nested.findall("model"):
        _dissolve(inner, nested)
    name = nested.get("name", "")
    own = f"{name}::{MODEL}"
    for element in _references(into, nested):
        _replace(element, lambda one: own if one == name else one)
    _place_by_origin(nested)
    given = nested.find("pose")
    if given is not None:  # it is not in the scope of the nested model
        nested.remove(given)
    pose = etree.Element("pose") if given is None else given
    for element in nested.iter("*"):
        _replace(element, lambda one: one if one in ("", WORLD) else f"{name}::{one}")
    first = nested.get("canonical_link") or next((link.get("name", "") for link in nested.findall("link")), "")
    frame = etree.SubElement(into, "frame", {"name": own, "attached_to": f"{name}::{first}"})
    frame.append(pose)
    if not pose.get("relative_to"):
        pose.set("relative_to", MODEL)
    for element in [child for child in nested if child.tag in _NAMED or child.tag == "plugin"]:
        if element.tag in _NAMED:
            element.set("name", f"{name}::{element.get('name', '')}")
        _place(element, own)
        into.append(element)
    into.remove(nested)


def _place_by_origin(model: Element) -> None:
    """State the pose of a model itself in place of that of its ``placement_frame``."""
    from lxml import etree

    frame = model.attrib.pop("placement_frame", "")
    if not frame:
        return
    X = read_pose(model) @ Frames(model).X_M(str(frame)).inverse()
    pose = model.find("pose")
    pose = etree.SubElement(model, "pose") if pose is None else pose
    for attribute in set(pose.attrib) - {"relative_to"}:
        del pose.attrib[attribute]
    pose.text = " ".join(map(repr, (*X.position, *X.rpy)))


def _place(element: Element, own: str) -> None:
    """State the model that a pose or an axis is relative to by default."""
    from lxml import etree

    if element.tag == "frame" and not element.get("attached_to"):
        element.set("attached_to", own)
    if element.tag == "link":
        pose = element.find("pose")
        pose = etree.SubElement(element, "pose") if pose is None else pose
        if not pose.get("relative_to"):
            pose.set("relative_to", own)
    for axis in (*element.findall("axis"), *element.findall("axis2")) if element.tag == "joint" else ():
        outdated, xyz = axis.find("use_parent_model_frame"), axis.find("xyz")
        if outdated is not None and (outdated.text or "").strip() in ("1", "true") and xyz is not None:
            axis.remove(outdated)
            xyz.set("expressed_in", own)


def _references(model: Element, without: Element) -> Iterator[Element]:
    """The elements of a model outside one that is nested in it."""
    for element in model:
        if element is not without:
            yield from element.iter("*")


def _replace(element: Element, new: Callable[[str], str]) -> None:
    """Replace the names of links, joints and frames that an element refers to."""
    for attribute in _REFERENCES:
        if element.get(attribute):
            element.set(attribute, new(element.get(attribute, "")))
    if element.tag == "mimic" and element.get("joint"):
        element.set("joint", new(element.get("joint", "")))
    if element.tag in ("parent", "child", "joint_name") and element.text:
        element.text = new(element.text.strip())


def _move_to_links(model: Element) -> None:
    """Express the poses of shapes in their links."""
    frames: Frames | None = None
    for link in model.findall("link"):
        for shape in (shape for tag in _PLACED for shape in link.findall(tag)):
            pose = shape.find("pose")
            if pose is None or not pose.get("relative_to"):
                continue
            base = pose.get("relative_to", "")
            frames = frames or Frames(model)
            X_LG = frames.X_M(link.get("name", "")).inverse() @ frames.X_M(base) @ read_pose(shape)
            for name in list(pose.attrib):
                del pose.attrib[name]
            pose.text = " ".join(map(repr, (*X_LG.position, *X_LG.rpy)))


def _add_world(model: Element) -> None:
    """A link for the world where a joint lets the model move on it, or several hold it."""
    from lxml import etree

    links = {link.get("name") for link in model.findall("link")}
    kinds = [joint.get("type") for joint in model.findall("joint") if WORLD in ends(joint)]
    if WORLD in links or kinds in ([], ["fixed"]):
        return
    link = etree.Element("link", {"name": WORLD})
    inertial = etree.SubElement(link, "inertial")
    etree.SubElement(inertial, "mass").text = "0"
    inertia = etree.SubElement(inertial, "inertia")
    for tag in ("ixx", "iyy", "izz"):
        etree.SubElement(inertia, tag).text = "0"
    model.insert(0, link)
