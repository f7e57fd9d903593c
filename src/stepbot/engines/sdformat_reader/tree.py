"""A copy of an SDFormat file that PyBullet can read: one model in a world, a tree of links, no joint to the world.

PyBullet rejects a joint whose parent is ``world``, and crashes on a second joint to a link and on a second root.
Everything left out is listed for the report. A fixed joint to the world becomes ``<static>``, the only way in which
PyBullet fixes the base.
"""

import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from stepbot.engines.resources import MeshSubstitutes
from stepbot.runtime.temporary import run_folder

from ..observation import EngineCannotRead, EngineRefused
from ..resources import resolve
from ..xml import Element, xml_root
from .frames import ends, read_pose
from .plain import join_links, plain

_SIBLINGS = ("link", "joint", "frame", "visual", "collision", "sensor", "light")
"""Elements that need a name that no other element beside them has."""
_SURROUNDINGS = ("sun", "ground_plane")
"""Names of models in almost every world of Gazebo."""
_READABLE = (".obj", ".stl", ".dae")
"""Suffixes of meshes; PyBullet rejects a file with any other, such as ``.glb``."""


def read_model(file: Path) -> Element:
    """The robot of an SDFormat file (:func:`the_model`), in plain form.

    Nested models are part of it, their elements named ``model::element``; poses of shapes are relative to their link.

    Raises:
        EngineRefused: The file is not XML.
        EngineCannotRead: It has no model, several, or an include.
    """
    model = plain(the_model(xml_root(file)))
    check_names(model)
    join_links(model)
    return model


def check_names(model: Element) -> None:
    """Check that links, joints and frames have unique names, and that joints have two ends.

    Raises:
        EngineRefused: A name is missing or used twice, or a joint lacks an end.
        EngineCannotRead: There are no links.
    """
    if model.find("link") is None:
        raise EngineCannotRead("the model has no links")
    for tag in ("link", "joint", "frame"):
        for name, count in Counter(element.get("name", "") for element in model.findall(tag)).items():
            if count > 1 or not name:
                raise EngineRefused(f"duplicate {tag} '{name}'" if name else f"<{tag}> without a name")
    for joint in model.findall("joint"):
        for end, tag in zip(ends(joint), ("parent", "child"), strict=True):
            if not end:
                raise EngineRefused(f"joint '{joint.get('name')}' has no <{tag}>")


def repeated_names(model: Element) -> Iterator[str]:
    """Names that elements of different types share, which libsdformat rejects."""
    for parent in (model, *model.findall("link"), *model.findall("joint")):
        names = [child.get("name") for child in parent if child.tag in _SIBLINGS and child.get("name")]
        where = f"{parent.tag} '{parent.get('name', '')}'"
        yield from (f"{where}: {count} elements named '{name}'" for name, count in Counter(names).items() if count > 1)


def the_model(top: Element) -> Element:
    """The only model below a root element; of several the only one that is not static, or the only one with joints.

    A sun and a floor that a world includes are its surroundings, and so is what stands or lies around a robot.

    Raises:
        EngineCannotRead: It has no model, several, or an include of another model.
    """
    models: list[Element] = [*top.findall("model"), *top.findall("world/model")]
    for is_robot in (_is_mobile, _has_joints):
        if len(models) > 1:
            models = [model for model in models if is_robot(model)] or models
    included = [(include.findtext("uri") or "").strip() for include in top.iter("include")]
    unknown = [uri for uri in included if uri.rstrip("/").rpartition("/")[2] not in _SURROUNDINGS]
    if unknown:
        raise EngineCannotRead(
            f"<include> of '{unknown[0]}' is not supported: `gz sdf -p FILE` prints the file with what it includes, "
            "`--package-path` names the folders that the meshes in that are relative to"
        )
    if len(models) != 1:
        names = ", ".join(f"'{model.get('name', '')}'" for model in models)
        raise EngineCannotRead(
            f"{len(models)} models that may be the robot ({names}), one expected: remove the others, or declare them "
            "<static>true</static>"
            if models
            else "no model in the file"
        )
    return models[0]


def _is_mobile(model: Element) -> bool:
    return (model.findtext("static") or "").strip() not in ("true", "1")


def _has_joints(model: Element) -> bool:
    return model.find("joint") is not None or any(map(_has_joints, model.findall("model")))


def joints_to_world(model: Element) -> list[Element]:
    """The joints that attach a model to the world; old files have a link named ``world``."""
    if any(link.get("name") == "world" for link in model.findall("link")):
        return []
    return [joint for joint in model.findall("joint") if "world" in ends(joint)]


def closing_joints(joints: Iterable[Element]) -> list[Element]:
    """The joints that close a loop: their child already has a parent joint, or they form a cycle.

    The first joint to a link is the one above it, unless links would remain without a way from the root.
    """
    joints = list(joints)
    above: dict[str, str] = {}
    closing = []
    for joint in joints:
        parent, child = ends(joint)
        if child in above or _is_above(child, parent, above):
            closing.append(joint)
        else:
            above[child] = parent
    if all(ends(joint)[1] in above for joint in closing):
        return closing
    children = {ends(joint)[1] for joint in joints}
    reached = {ends(joint)[0] for joint in joints} - children
    tree = list[Element]()
    while grown := [one for one in joints if ends(one)[0] in reached and ends(one)[1] not in reached][:1]:
        tree += grown
        reached.add(ends(grown[0])[1])
    return [joint for joint in joints if joint not in tree] if children <= reached else closing


def _is_above(link: str, other: str, above: dict[str, str]) -> bool:
    while other != link and other in above:
        other = above[other]
    return other == link


def round_shapes(file: Path) -> int:
    """Number of cylinders and capsules in a file, visuals and collisions together."""
    return sum(
        1 for geometry in read_model(file).iter("geometry") for _ in geometry.iterchildren("cylinder", "capsule")
    )


@contextmanager
def tree_copy(file: Path, *, held: bool = False, shapes: bool = True) -> Iterator[tuple[Path, list[str]]]:
    """Path of the copy, which exists as long as the context, and what was left out.

    Args:
        held: Whether a base fixed to the world stays fixed; PyBullet reports no mass of such a base.
        shapes: Whether the copy has shapes; loading them takes most of the time.

    Raises:
        EngineRefused: The file is not XML.
        EngineCannotRead: Even a copy would make PyBullet crash or misread it.
    """
    from lxml import etree

    model = read_model(file)
    to_world = joints_to_world(model)
    closing = closing_joints(joint for joint in model.findall("joint") if joint not in to_world)
    notes = [f"read from a copy without joint '{joint.get('name', '')}' to the world" for joint in to_world]
    notes += [f"read from a copy without closing joint '{joint.get('name', '')}'" for joint in closing]
    for joint in (*to_world, *closing):
        model.remove(joint)
    check_readable(model)
    links = {link.get("name") for link in model.findall("link")}
    if held and any(joint.get("type") == "fixed" and set(ends(joint)) & links for joint in to_world):
        etree.SubElement(model, "static").text = "1"
    if not shapes:
        for link in model.iterfind("link"):
            for shape in (*link.findall("visual"), *link.findall("collision")):
                link.remove(shape)
    top = etree.Element("sdf", {"version": "1.9"})
    etree.SubElement(top, "world", {"name": "default"}).append(model)
    with tempfile.TemporaryDirectory(dir=run_folder()) as folder:
        notes += _resolve_meshes(model, file, Path(folder))
        copy = Path(folder) / "model.sdf"
        copy.write_bytes(etree.tostring(top, encoding="UTF-8", xml_declaration=True))
        yield copy, notes


def _resolve_meshes(model: Element, file: Path, folder: Path) -> tuple[str, ...]:
    """Make paths of meshes absolute, to substitutes in a folder where PyBullet does not read them; returns notes."""
    substitutes = MeshSubstitutes("PyBullet", _READABLE)
    for number, uri in enumerate(model.iter("uri")):
        mesh = resolve((uri.text or "").strip(), file)
        if mesh is None:
            continue
        content = substitutes.of(mesh)
        if content is not None:
            mesh = folder / f"mesh_{number}.obj"
            mesh.write_bytes(content)
        uri.text = mesh.absolute().as_posix()
    return substitutes.notes()


_IGNORED = {
    "relative_to": ".//pose[@relative_to and @relative_to!='']",
    "expressed_in": ".//xyz[@expressed_in and @expressed_in!='']",
    "degrees": ".//pose[@degrees='true']",
    "rotation_format": ".//pose[@rotation_format='quat_xyzw']",
}
"""Attributes, and where they have an effect."""
_SHAPES = {"box", "capsule", "cylinder", "mesh", "plane", "sphere"}
"""Shapes of SDFormat that PyBullet reads."""


def _is_placed(joint: Element) -> bool:
    """Whether a joint moves about another point, or along another direction, than without its pose."""
    X_CJ = read_pose(joint)
    turns = joint.get("type") in ("revolute", "continuous")
    return joint.get("type") != "fixed" and (any(X_CJ.rpy) or (turns and any(X_CJ.position)))


def check_readable(model: Element) -> None:
    """Reject features on which PyBullet is known to crash or which it misreads.

    Raises:
        EngineCannotRead: The model has such a feature.
    """
    ignored = [name for name, path in _IGNORED.items() if model.xpath(path)]
    ignored += ["poses of joints"] if any(map(_is_placed, model.findall("joint"))) else []
    if ignored:
        raise EngineCannotRead(f"PyBullet ignores {', '.join(ignored)}")
    kinds = sorted(
        {str(joint.get("type")) for joint in model.findall("joint")} - {"fixed", "revolute", "continuous", "prismatic"}
    )
    if kinds:
        raise EngineCannotRead(f"PyBullet ignores joints of type {', '.join(kinds)} in SDFormat")
    unknown = sorted({str(shape.tag) for shape in model.iterfind(".//geometry/*")} - _SHAPES)
    if unknown:
        raise EngineCannotRead(f"PyBullet has no shape {', '.join(unknown)} in SDFormat")
    children = {ends(joint)[1] for joint in model.findall("joint")}
    roots = [link.get("name", "") for link in model.findall("link") if link.get("name") not in children]
    if len(roots) != 1:
        raise EngineCannotRead(f"PyBullet crashes on {len(roots)} root links: {', '.join(roots)}")
