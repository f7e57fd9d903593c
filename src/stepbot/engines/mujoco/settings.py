"""What a compiled MJCF sets beside what the model of a robot has: contact, tendons, noise, lights, the solver.

Numbers that depend on how a file describes a pose are left out: those that remain are equal in all words for one robot.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from stepbot.geometry.spatial import Array
from stepbot.runtime.temporary import run_folder

from ..description.statements import statements
from .compiled import Compiled

_KINDS = {
    "geom": "condim friction gap margin priority solimp solmix solref",
    "joint": "margin solimp solref",
    "equality": "active0 objtype solimp solref type",
    "tendon": "damping frictionloss lengthspring limited margin range stiffness solimp_fri solimp_lim solref_fri "
    "solref_lim rgba width",
    "actuator": "actlimited actrange biasprm biastype cranklength ctrllimited ctrlrange dynprm dyntype forcelimited "
    "forcerange gainprm gaintype gear trntype",
    "sensor": "cutoff datatype dim noise objtype reftype type",
    "light": "active ambient attenuation castshadow cutoff diffuse exponent specular",
    "cam": "fovy ipd orthographic projection resolution sensorsize",
    "mat": "emission reflectance shininess specular rgba",
}
"""For each kind of element the numbers that are compared, as fields of MuJoCo's model."""
_PREFIXES = {"joint": "jnt", "equality": "eq"}
_OBJECTS = {"cam": "CAMERA", "mat": "MATERIAL"}
_OPTIONS = (
    "cone density disableflags enableflags impratio integrator iterations jacobian ls_iterations ls_tolerance magnetic "
    "o_friction o_margin o_solimp o_solref solver timestep tolerance viscosity wind"
)
_ACTUATORS = re.compile(r"/(?:motor|position|velocity|intvelocity|damper|cylinder|muscle|adhesion)(?=[^/]*$)")
_ALWAYS_THERE = ("mujoco/option", "mujoco/size", "mujoco/statistic", "mujoco/visual")
"""Elements without which a file has the same settings by default."""


def settings(compiled: Compiled) -> Mapping[str, tuple[float, ...]]:
    """Numbers by element and field, as in ``geom 'pad' friction``; elements without names are numbered."""
    return {where: values for where, values in _all(compiled) if np.isfinite(values).all()}


def content_hash(compiled: Compiled) -> str:
    """A hash of the whole model but the names of its files, the same however its rotations are stated."""
    model, whole = compiled.model, sha256()
    kinds = compiled.engine.mjtJoint
    before = {int(kinds.mjJNT_FREE): 3, int(kinds.mjJNT_BALL): 0}
    joints = zip(model.jnt_type.tolist(), model.jnt_qposadr.tolist(), strict=True)
    turns = [start + before[kind] for kind, start in joints if kind in before]
    """Where coordinates have quaternions."""
    waiting = [("model", model)]
    while waiting:
        place, value = waiting.pop()
        if isinstance(value, np.ndarray | int | float | bytes):
            content = np.array(value)
            if place.endswith("quat"):
                _turn_positive(content.reshape(-1, 4))
            for at in turns if place.endswith(("qpos0", "qpos_spring", "key_qpos")) else ():
                _turn_positive(content.reshape(-1, model.nq)[:, at : at + 4])
            if content.dtype.kind == "f":
                content = _rounded(content)
            whole.update(f"{place} {content.dtype} {content.shape}".encode() + content.tobytes())
        elif not callable(value):
            waiting += [(f"{place}.{one}", getattr(value, one)) for one in dir(value) if _is_content(one)]
    return whole.hexdigest()


def stated_defaults(compiled: Compiled, file: Path) -> tuple[str, ...]:
    """The places of attributes that MuJoCo leaves out where it saves the file that it has read last.

    They state what it takes without them. Settings of the compiler are not among them: they are applied, not saved.
    """
    with TemporaryDirectory(dir=run_folder()) as folder:
        saved = Path(folder) / "saved.xml"
        compiled.engine.mj_saveLastXML(str(saved), compiled.model)
        kept = {_as_saved(statement.place) for statement in statements(saved, "mjcf")}
    elements = {place.rpartition("@")[0] for place in kept}
    places = (
        statement.place
        for statement in statements(file, "mjcf")
        if "@" in statement.place and _as_saved(statement.place) not in kept
    )
    unsaved = ((place, _as_saved(place).rpartition("@")[0]) for place in places)
    return tuple(place for place, element in unsaved if element in elements or element.startswith(_ALWAYS_THERE))


def _as_saved(place: str) -> str:
    """A place in a file as MuJoCo saves it, with one tag for all actuators."""
    return _ACTUATORS.sub("/general", place)


def _turn_positive(quaternions: Array) -> None:
    """Make the largest number of each quaternion positive: the other sign is the same rotation."""
    largest = np.take_along_axis(quaternions, np.abs(quaternions).round(6).argmax(axis=1)[:, None], axis=1)
    quaternions *= np.where(largest < 0.0, -1.0, 1.0)


def _rounded(values: Array) -> Array:
    """The numbers to nine digits, those of rounding as 0."""
    finite = np.isfinite(values) & (np.abs(values) > 1e-12)
    exponents = np.floor(np.log10(np.abs(values), where=finite, out=np.zeros(values.shape)))
    return np.where(
        finite,
        np.round(values * 10.0 ** (8 - exponents)) * 10.0 ** (exponents - 8),
        np.where(np.isinf(values), values, 0.0),
    )


def _is_content(field: str) -> bool:
    return not field.startswith("_") and field not in ("paths", "signature") and not field.endswith("_pathadr")


def _all(compiled: Compiled) -> Iterator[tuple[str, tuple[float, ...]]]:
    engine, model = compiled.engine, compiled.model
    for name in _OPTIONS.split():
        yield f"option {name}", _numbers(getattr(model.opt, name, ()))
    equalities = _equalities(compiled)
    for kind, fields in _KINDS.items():
        prefix, object_ = _PREFIXES.get(kind, kind), getattr(engine.mjtObj, f"mjOBJ_{_OBJECTS.get(kind, kind.upper())}")
        for field in fields.split():
            rows = getattr(model, f"{prefix}_{field}", ())
            for index, row in enumerate(rows):
                name = engine.mj_id2name(model, object_, index) or ""
                called = equalities[index] if kind == "equality" else repr(name) if name else index + 1
                yield f"{kind} {called} {field}", _numbers(row)
    for index, row in enumerate(model.wrap_prm):
        yield f"tendon part {index + 1} coefficient", _numbers(row)
    for index in np.flatnonzero(model.eq_type == int(engine.mjtEq.mjEQ_JOINT)).tolist():
        yield f"equality {equalities[index]} polycoef", _numbers(model.eq_data[index][:5])
        yield f"equality {equalities[index]} joints", (float(model.eq_obj2id[index] >= 0),)


def _equalities(compiled: Compiled) -> list[str]:
    """What constraints are called: their names, or what they relate, whatever their order."""
    model, lines, seen = compiled.model, list[str](), Counter[str]()
    for index in range(model.neq):
        kind = int(model.eq_objtype[index])
        ends = [int(one) for one in (model.eq_obj1id[index], model.eq_obj2id[index]) if one >= 0]
        names = [compiled.engine.mj_id2name(model, kind, end) or str(end) for end in ends]
        name = compiled.engine.mj_id2name(model, compiled.engine.mjtObj.mjOBJ_EQUALITY, index)
        called = repr(name) if name else " ".join(map(repr, names))
        seen[called] += 1
        lines.append(called if seen[called] == 1 else f"{called} {seen[called]}")
    return lines


def _numbers(value: object) -> tuple[float, ...]:
    return tuple(float(one) for one in np.ravel(np.asarray(value, dtype=float)))
