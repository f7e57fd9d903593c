"""Rewrites descriptions as other programs write them: other units, conventions and structure, and the same robot."""

import warnings
from collections.abc import Callable
from random import Random

import numpy as np
from lxml import etree
from scipy.spatial.transform import Rotation

from stepbot.geometry.spatial import Array

Element = etree._Element
SEQUENCES = ("xyz", "XYZ", "zyx", "ZYX", "xzy", "YXZ", "zxz", "ZXZ")
"""Euler sequences of MuJoCo: small letters turn about moving axes."""


def rewritten(written_in: str, text: bytes, random: Random) -> dict[str, bytes]:
    """The files of a rewritten description; the first one is the description."""
    return _REWRITING[written_in](etree.fromstring(text), random)


def _numbers(text: str | None, default: str = "") -> Array:
    return np.array([float(one) for one in (text or default).split()])


def _text(values: Array) -> str:
    return " ".join(repr(float(one)) for one in values)


def _turn(quaternion: Array) -> Rotation:
    """The rotation of a quaternion (w, x, y, z)."""
    return Rotation.from_quat(np.roll(quaternion, -1))


def _quaternion(turn: Rotation) -> Array:
    return np.roll(turn.as_quat(), 1)


def _mjcf(root: Element, random: Random) -> dict[str, bytes]:
    compiler = root.find("compiler")
    framed = random.random() < 0.5
    for body in [*root.iter("body")] if framed else []:
        if random.random() < 0.5 and body.find("freejoint") is None and body.getparent().tag in ("body", "worldbody"):
            _put_into_a_frame(body, random)
    # Relations of equalities start at the references, and so does a robot without a keyframe.
    if root.find("equality") is None and root.find("keyframe") is not None and random.random() < 0.5:
        for body in root.iter("body"):
            _refer_to_other_positions(body, random)
    _write_turns(root, compiler, random)
    if random.random() < 0.5:
        compiler.set("autolimits", "false")
        for element in root.iter("joint", "position", "velocity", "motor", "general"):
            for limits, limited in (("range", "limited"), ("actuatorfrcrange", "actuatorfrclimited")):
                if element.get(limits) and element.getparent().tag == "body":
                    element.set(limited, "true")
            for limits, limited in (("ctrlrange", "ctrllimited"), ("forcerange", "forcelimited")):
                if element.get(limits):
                    element.set(limited, "true")
    if random.random() < 0.5:
        compiler.set("meshdir", "meshes")
        for mesh in root.iterfind("asset/mesh"):
            mesh.set("file", mesh.get("file").removeprefix("meshes/"))
    files = {}
    actuators = root.find("actuator")
    if actuators is not None and random.random() < 0.5:
        included = etree.Element("mujocoinclude")
        root.replace(actuators, etree.Element("include", file="parts/actuators.xml"))
        included.append(actuators)
        files["parts/actuators.xml"] = etree.tostring(included)
    return {"drawn.xml": etree.tostring(root), **files}


def _refer_to_other_positions(body: Element, random: Random) -> None:
    """State the body, and the axes in it, where its joints are at other positions than 0."""
    joints = body.findall("joint")
    if any(joint.get("type", "hinge") not in ("hinge", "slide") or joint.get("ref") for joint in joints):
        return
    turn, place = Rotation.identity(), np.zeros(3)  # of the moved body in the one at 0
    for joint in reversed(joints):
        axis, anchor = _numbers(joint.get("axis"), "0 0 1"), _numbers(joint.get("pos"), "0 0 0")
        ref = random.uniform(-0.3, 0.3)
        joint.set("ref", repr(ref))
        joint.set("axis", _text(turn.inv().apply(axis)))
        joint.set("pos", _text(turn.inv().apply(anchor - place)))
        if joint.get("type", "hinge") == "slide":
            place = place + ref * axis / np.linalg.norm(axis)
        else:
            step = Rotation.from_rotvec(ref * axis / np.linalg.norm(axis))
            turn, place = step * turn, anchor + step.apply(place - anchor)
    before, at = _turn(_numbers(body.get("quat"), "1 0 0 0")), _numbers(body.get("pos"), "0 0 0")
    body.set("pos", _text(at + before.apply(place)))
    body.set("quat", _text(_quaternion(before * turn)))


def _put_into_a_frame(body: Element, random: Random) -> None:
    """Give a body an own frame, which stands somewhere else, around it."""
    parent, turn = body.getparent(), Rotation.from_euler("z", random.uniform(-1.0, 1.0))
    place = np.array([random.uniform(-0.1, 0.1) for _ in range(3)])
    frame = etree.Element("frame", pos=_text(place), quat=_text(_quaternion(turn)))
    parent.replace(body, frame)
    frame.append(body)
    body.set("pos", _text(turn.inv().apply(_numbers(body.get("pos"), "0 0 0") - place)))
    body.set("quat", _text(_quaternion(turn.inv() * _turn(_numbers(body.get("quat"), "1 0 0 0")))))


def _write_turns(root: Element, compiler: Element, random: Random) -> None:
    """Write orientations in another way, and angles in degrees."""
    degrees, sequence = random.random() < 0.5, random.choice(SEQUENCES)
    unit = np.degrees if degrees else np.asarray
    for element in root.iter():
        given = element.get("quat") if isinstance(element.tag, str) and element.tag != "key" else None
        if given is None:
            continue
        turn, way = _turn(_numbers(given)), random.choice(["quat", "euler", "axisangle", "xyaxes", "length"])
        if way == "euler" and (angles := _euler(turn, sequence)) is not None:
            element.set("euler", _text(unit(angles)))
        elif way == "axisangle" and turn.magnitude() > 1e-3:
            element.set("axisangle", _text(np.append(turn.as_rotvec() / turn.magnitude(), unit(turn.magnitude()))))
        elif way == "xyaxes":
            element.set("xyaxes", _text(turn.as_matrix()[:, :2].T.ravel()))
        else:
            if way == "length":
                element.set("quat", _text(-2.0 * _numbers(given)))
            continue
        del element.attrib["quat"]
    compiler.set("eulerseq", sequence)
    if degrees:
        compiler.set("angle", "degree")
        for joint in root.iterfind("worldbody//joint"):
            turns = joint.get("type", "hinge") in ("hinge", "ball")
            for name in ("range", "ref", "springref") if turns else ():
                if joint.get(name):
                    joint.set(name, _text(np.degrees(_numbers(joint.get(name)))))


def _euler(turn: Rotation, sequence: str) -> Array | None:
    """Angles [rad] in a sequence of MuJoCo, whose letters have the other case in SciPy; None where they are inexact."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # gimbal lock
        angles = turn.as_euler(sequence.swapcase())
    exact = (Rotation.from_euler(sequence.swapcase(), angles).inv() * turn).magnitude() < 1e-13
    return angles if exact else None


def _urdf(root: Element, random: Random) -> dict[str, bytes]:
    files = {}
    if random.random() < 0.5:
        files["package.xml"] = b"<package><name>drawn_description</name></package>"
        for mesh in root.iter("mesh"):
            mesh.set("filename", f"package://drawn_description/{mesh.get('filename')}")
    if random.random() < 0.5:
        elements = [*root]
        root[:] = random.sample(elements, len(elements))
    for element in root.iter("origin", "axis") if random.random() < 0.5 else ():
        for name, text in element.attrib.items():
            element.set(name, "  ".join(f"{float(one):+.17e}" for one in text.split()))
    text = etree.tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True)
    if random.random() < 0.5:
        text = b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n")
    return {"drawn.urdf": text, **files}


def _sdf(root: Element, random: Random) -> dict[str, bytes]:
    model = root.find("model")
    if random.random() < 0.5:
        _put_links_into_frames(model, random)
    joints = model.findall("joint")
    if random.random() < 0.5 and len({joint.findtext("child") for joint in joints}) == len(joints):
        for joint, other in zip(joints, [etree.Element("joint") for _ in joints], strict=True):
            model.replace(joint, other)
        for place, joint in zip(model.findall("joint"), random.sample(joints, len(joints)), strict=True):
            model.replace(place, joint)
    for pose in root.iter("pose") if random.random() < 0.5 else ():
        if not pose.get("rotation_format") and pose.text and pose.text.strip():
            values = _numbers(pose.text)
            pose.text = _text(np.append(values[:3], np.degrees(values[3:])))
            pose.set("degrees", "true")
    return {"drawn.sdf": etree.tostring(root, encoding="utf-8", xml_declaration=True)}


def _put_links_into_frames(model: Element, random: Random) -> None:
    """State poses of links in a frame that is attached to another one."""
    for name, attached_to, pose in (("a", "", "0.1 0.2 0.3 0 0 0.5"), ("b", "a", "0 0 0.1 0 0 -0.2")):
        frame = etree.SubElement(model, "frame", name=name, **({"attached_to": attached_to} if attached_to else {}))
        etree.SubElement(frame, "pose").text = pose
    turn = Rotation.from_euler("z", 0.5 - 0.2)
    place = np.array([0.1, 0.2, 0.4])
    for link in model.iterfind("link"):
        pose = link.find("pose")
        if pose is None or pose.get("relative_to") or random.random() < 0.3:
            continue
        values = _numbers(pose.text)
        inside = turn.inv() * Rotation.from_euler("xyz", values[3:])
        pose.set("relative_to", "b")
        pose.set("rotation_format", "quat_xyzw")
        pose.text = _text(np.append(turn.inv().apply(values[:3] - place), inside.as_quat()))


_REWRITING: dict[str, Callable[[Element, Random], dict[str, bytes]]] = {"mjcf": _mjcf, "urdf": _urdf, "sdf": _sdf}
