"""MJCF as MuJoCo compiles it, without the meshes and textures whose files are missing."""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.diagnostics import did_you_mean
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_files import KINDS
from stepbot.geometry.primitives import Primitive
from stepbot.geometry.spatial import Pose
from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.tuning import Integrator, Simulation
from stepbot.runtime.file import is_file

from ..description.description import DescribedShape, Description, MeshFiles, ellipsoid_mesh
from ..description.mjcf_vocabulary import LED, MJCF, unread_of_mjcf
from ..description.vocabulary import Unread
from ..observation import EngineRefused, Observation, Request
from ..xml import xml_root
from .compiled import Compiled
from .model import collected_warnings
from .observer import observe_model
from .shapes import collides, color_of, geoms, is_visual, primitive_of, surface_of

_MOST_MODELS = 100
"""Models that may be attached."""
_SINGLE = 1e-5
"""Difference of meshes in single precision, as a share of their size."""


@collected_warnings()
def describe_mjcf(file: str, _packages: Iterable[Path] = ()) -> Description:
    """Read an MJCF, whose meshes are relative to it.

    Raises:
        EngineRefused: MuJoCo does not compile it, or it has no bodies.
    """
    import mujoco as engine

    from .motion import close_by_newton

    path = Path(file)
    roots = _roots(path)
    attached = _attached(path, roots)
    folders = [folder for main, some in [(path, roots), *attached] for folder in _mesh_folders(main, some)]
    try:
        spec = engine.MjSpec.from_file(file)
        unread = _drop_missing(spec, path.parent, folders)
        model = spec.compile()
    except ValueError as error:
        text = str(error).replace(f"{path.parent.as_posix()}/", "").strip()
        raise EngineRefused(text if roots[1:] or attached else _placed(text)) from error
    if model.nbody < 2:  # the first one is the world
        raise EngineRefused("the file has no bodies")
    compiled = Compiled(engine, model, {})
    request = Request(file, "mjcf", configurations=({},), simulate=0.0)
    led = {compiled.name("BODY", body) for body in np.flatnonzero(model.body_mocapid >= 0).tolist()}
    closures = close_by_newton(compiled, request)
    kept = tuple(closure for closure in closures if not led & {closure.link_a, closure.link_b})
    observation = replace(observe_model(compiled, request), closures=kept)
    poses = observation.poses[0]
    X_PC = {
        joint.child: poses[joint.parent].inverse() @ poses[joint.child]
        for joint in observation.joints
        if joint.parent in poses
    }
    meshes = _MeshFiles(compiled, spec, path, folders)
    of_models = [one for _, some in attached for one in some]
    shapes = tuple(shape for body in compiled.bodies if body for shape in _shapes(compiled, body, meshes))
    first = compiled.bodies[0]
    return Description(
        replace(observation, frames=_without_ends(observation)),
        X_PC,
        shapes,
        tuple(sorted({*unread, *meshes.files.unread})),
        (
            *(lost for root, name, at in (*roots, *of_models) for lost in unread_of_mjcf(root, name, at)),
            *_direct(compiled),
            *_coupled(compiled),
            *_endless(compiled),
            *_forced(compiled),
            *((Unread(LED, len(closures) - len(kept), 0, effect=MJCF.effects["mocap"]),) if kept != closures else ()),
        ),
        (*(path.parent / name for _, name, _ in (*roots, *of_models) if name), *meshes.files.files),
        X_WR=compiled.X_WB(compiled.data({}), first) if first else Pose(),
        free_roots=tuple(compiled.name("BODY", int(model.jnt_bodyid[joint])) for joint in compiled.free_joints),
        assumed=_from_geoms(spec, compiled),
        unsupported=tuple(_unsupported(compiled)),
        simulation=_simulation(root for root, *_ in roots),
    )


def _placed(text: str) -> str:
    """MuJoCo's message about a single file with its line first, and the known name that an unknown one resembles."""
    place = re.search(r"^Element (?:'(\w*)'|name '.*', id \d+), line (\d+)\s*$", text, re.MULTILINE)
    if place is None:
        return text
    near: tuple[str, ...] = ()
    if attribute := re.search(r"unrecognized attribute: '(\w+)'", text):
        stated = (names for path, names in MJCF.read.items() if path.endswith(f"/{place[1]}"))
        near = did_you_mean(attribute[1], (name for names in stated for name in names.split()))
    elif "unrecognized element" in text:
        near = did_you_mean(place[1], (path.rpartition("/")[2] for path in MJCF.read))
    return "\n".join((f"line {place[2]}: {text}", *near))


_Root = tuple[Any, str, str]
"""The root element of a file, its name, and the path of the element that includes it."""


def _roots(path: Path, main: str = "") -> list[_Root]:
    """The root elements of a model's file and of each included one.

    Names are relative to the folder of ``path``. Includes are relative to the folder of the model's file.

    Args:
        main: Name of the model's file; empty for ``path`` itself.

    Raises:
        EngineRefused: One is not XML.
    """
    pending, roots = [(main, "mujoco")], list[_Root]()
    folder = Path(main).parent
    while pending:
        name, at = pending.pop(0)
        try:
            root = xml_root(path.parent / name if name else path)
        except (EngineRefused, OSError) as error:
            raise EngineRefused(f"{name or path.name}: {error}") from error
        roots.append((root, name, at))
        known = {one for _, one, _ in roots}
        includes = (((folder / one.get("file", "")).as_posix(), MJCF.path_of(one, at)) for one in root.iter("include"))
        pending += [include for include in includes if include[0] not in known]
    return roots


def _attached(path: Path, roots: Iterable[_Root]) -> list[tuple[Path, list[_Root]]]:
    """The models that a file attaches, and those that these attach, each with its file.

    Raises:
        EngineRefused: One is not XML.
    """
    pending, attached = [("", [*roots])], dict[str, list[_Root]]()
    while pending:
        main, some = pending.pop(0)
        named = (model.get("file", "") for root, *_ in some for model in root.iter("model"))
        for name in ((Path(main).parent / one).as_posix() for one in named if one):
            if name not in attached and len(attached) < _MOST_MODELS:
                attached[name] = _roots(path, name)
                pending.append((name, attached[name]))
    return [(path.parent / name, some) for name, some in attached.items()]


def _mesh_folders(main: Path, roots: Iterable[_Root]) -> list[Path]:
    """The folders in which MuJoCo looks for the meshes of a model, by its file."""
    stated = (one.get("meshdir") or one.get("assetdir") for root, *_ in roots for one in root.iter("compiler"))
    return [*(main.parent / folder for folder in stated if folder), main.parent]


def _without_ends(observation: Observation) -> dict[str, tuple[str, Pose]]:
    """The frames without the sites that mark the ends of closures."""
    closures = {closure.name for closure in observation.closures or ()}
    return {name: place for name, place in (observation.frames or {}).items() if name.split(SCOPE)[0] not in closures}


def _from_geoms(spec: Any, compiled: Compiled) -> tuple[str, ...]:
    """Bodies whose mass properties MuJoCo computes from their geoms."""
    always = int(spec.compiler.inertiafromgeom) == int(compiled.engine.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE)
    stated = {body.id for body in spec.bodies if body.explicitinertial}
    model = compiled.model
    return tuple(
        compiled.name("BODY", b)
        for b in compiled.bodies
        if b and model.body_mass[b] > 0.0 and (always or b not in stated)
    )


def _unsupported(compiled: Compiled) -> Iterator[str]:
    """Equality constraints that are neither closures nor mimics, nor relate more joints than other formats can."""
    engine, model = compiled.engine, compiled.model
    known = (engine.mjtEq.mjEQ_CONNECT, engine.mjtEq.mjEQ_WELD)
    read = {e for _, e in compiled.couplings.values()} | set(_of_several(compiled))
    for e in range(model.neq):
        kind, name = engine.mjtEq(model.eq_type[e]), compiled.name("EQUALITY", e)
        if not model.eq_active0[e] or kind in known or e in read:
            continue
        if kind in (engine.mjtEq.mjEQ_JOINT, engine.mjtEq.mjEQ_TENDON):
            yield f"equality constraint '{name}' is not a linear relation of two joints, of which one follows no other"
        else:
            yield f"equality constraint '{name}' of type '{kind.name.removeprefix('mjEQ_').lower()}' is not supported"


def _of_several(compiled: Compiled) -> list[int]:
    """Equality constraints of more than two joints, by fixed tendons."""
    return [e for e, (factors, _) in compiled.relations.items() if len(factors) > 2]


def _coupled(compiled: Compiled) -> Iterator[Unread]:
    names = [compiled.name("EQUALITY", e) for e in _of_several(compiled)]
    if names:
        effect = f"{', '.join(names)}: the joints move independently, for no other format relates more than two"
        yield Unread("<tendon> in <equality>", len(names), 0, effect=effect)


def _direct(compiled: Compiled) -> Iterator[Unread]:
    """Geoms whose `solref` gives a stiffness and a damping, for which the model has no place."""
    count = int(np.any(compiled.model.geom_solref < 0.0, axis=1).sum())
    if count:
        yield Unread("negative `solref` of <geom>", count, 0, effect="contacts are as stiff as the formats' defaults")


def _endless(compiled: Compiled) -> Iterator[Unread]:
    """Planes and height fields of bodies; those of the world are no part of a robot."""
    kinds = compiled.engine.mjtGeom
    for kind, words in ((kinds.mjGEOM_PLANE, "planes"), (kinds.mjGEOM_HFIELD, "height fields")):
        endless = [
            compiled.name("BODY", b)
            for b in compiled.bodies
            if b
            for g in geoms(compiled, b)
            if compiled.model.geom_type[g] == kind
        ]
        if endless:
            yield Unread(f"{words} in <body>", len(endless), 0, effect=f"of {', '.join(endless)}")


def _forced(compiled: Compiled) -> Iterator[Unread]:
    """Passive forces of free joints, which defaults of all joints give them, too."""
    model = compiled.model
    for joint in compiled.free_joints:
        dofs = slice(int(model.jnt_dofadr[joint]), int(model.jnt_dofadr[joint]) + 6)
        stated = {
            "stiffness": model.jnt_stiffness[joint],
            "damping": model.dof_damping[dofs],
            "frictionloss": model.dof_frictionloss[dofs],
            "armature": model.dof_armature[dofs],
        }
        names = [f"'{name}'" for name, values in stated.items() if np.any(values)]
        if names:
            body = compiled.name("BODY", int(model.jnt_bodyid[joint]))
            effect = f"of '{body}': it floats without; `<freejoint>` has none"
            yield Unread(f"{' and '.join(names)} of a free joint", 1, 0, effect=effect)


def _simulation(roots: Iterable[Any]) -> Simulation:
    """The settings that the file states."""
    stated = {name: value for root in roots for option in root.iter("option") for name, value in option.attrib.items()}
    integrator = stated.get("integrator", "").lower()
    step = stated.get("timestep")
    return Simulation(
        timestep=None if step is None else float(step),
        integrator=Integrator(integrator) if integrator in set(Integrator) else None,
    )


class _MeshFiles:
    """The meshes of a model: of their files, in double precision, else as MuJoCo has them."""

    def __init__(self, compiled: Compiled, spec: Any, path: Path, folders: Sequence[Path]) -> None:
        self.files = MeshFiles(path)
        self._compiled, self._spec, self._folders = compiled, spec, folders
        self._meshes: dict[int, tuple[TriMesh, Pose, str]] = {}

    def mesh(self, number: int) -> tuple[TriMesh, Pose, str]:
        """A mesh, its pose in the frame that MuJoCo gives it, and its name or file."""
        if number not in self._meshes:
            self._meshes[number] = self._read(number)
        return self._meshes[number]

    def _read(self, number: int) -> tuple[TriMesh, Pose, str]:
        model, name = self._compiled.model, self._compiled.name("MESH", number)
        stated = next((mesh for mesh in self._spec.meshes if mesh.id == number), None)
        if stated is not None and stated.file and not any(stated.refpos) and list(stated.refquat) == [1, 0, 0, 0]:
            files = dict.fromkeys(folder / stated.file for folder in self._folders if is_file(folder / stated.file))
            X = Pose.from_quaternion(model.mesh_quat[number].tolist(), model.mesh_pos[number]).inverse()
            for file in (one for one in files if one.suffix.lower() in KINDS):
                mesh = self.files.mesh(file.as_posix(), tuple(stated.scale))
                # Models that are attached may name different files alike.
                if mesh is not None and (len(files) == 1 or self._is_like(mesh, X, number)):
                    return mesh, X, stated.file
        first = model.mesh_faceadr[number]
        faces = model.mesh_face[first : first + model.mesh_facenum[number]]
        return TriMesh.of(self._compiled.vertices(number), faces), Pose(), name

    def _is_like(self, mesh: TriMesh, X_GM: Pose, number: int) -> bool:
        """Whether a mesh is where MuJoCo has one, by their boxes."""
        vertices, moved = self._compiled.vertices(number), X_GM.apply(mesh.vertices)
        size = float(np.ptp(vertices, axis=0).max())
        ours, theirs = ([points.min(axis=0), points.max(axis=0)] for points in (vertices, moved))
        return bool(np.allclose(ours, theirs, rtol=0.0, atol=_SINGLE * size))


def _drop_missing(spec: Any, folder: Path, mesh_folders: Sequence[Path]) -> tuple[str, ...]:
    """Remove references to missing meshes, height fields and textures; returns the files as in the description."""
    missing = set()
    for mesh in list(spec.meshes):
        if mesh.file and not any(is_file(one / mesh.file) for one in mesh_folders):
            missing.add(mesh.file)
            for geom in [geom for geom in spec.geoms if geom.meshname == mesh.name]:
                spec.delete(geom)
            spec.delete(mesh)
    gone = {
        texture.name
        for texture in spec.textures
        if any(name and not _is_there(folder, spec.texturedir, name) for name in (texture.file, *texture.cubefiles))
    }
    for material in spec.materials:
        material.textures = ["" if name in gone else name for name in material.textures]
    for texture in [texture for texture in spec.textures if texture.name in gone]:
        spec.delete(texture)
    return tuple(sorted(missing))


def _is_there(folder: Path, below: str, name: str) -> bool:
    return is_file(folder / below / name) or is_file(folder / name)


def _shapes(compiled: Compiled, body: int, meshes: _MeshFiles) -> Iterator[DescribedShape]:
    """Geoms of a body: visuals, collisions, or both."""
    model = compiled.model
    for g in geoms(compiled, body):
        X_LG, uri = Pose.from_quaternion(model.geom_quat[g].tolist(), model.geom_pos[g]), ""
        geometry: TriMesh | Primitive | None
        is_round = model.geom_type[g] == compiled.engine.mjtGeom.mjGEOM_ELLIPSOID
        if model.geom_type[g] == compiled.engine.mjtGeom.mjGEOM_MESH:
            geometry, X_GM, uri = meshes.mesh(int(model.geom_dataid[g]))
            X_LG = X_LG @ X_GM
        else:
            geometry = ellipsoid_mesh(model.geom_size[g]) if is_round else primitive_of(compiled, g)
        if geometry is None:  # a plane or a height field
            continue
        name = compiled.name("GEOM", g) or compiled.name("MESH", int(model.geom_dataid[g]))
        shape = DescribedShape(compiled.name("BODY", body), name, geometry, X_LG, color_of(compiled, g), mesh=uri)
        shape = replace(shape, approximated="an ellipsoid" if is_round else "")
        if is_visual(compiled, g, mjcf=True):
            yield shape
        if collides(compiled, g):
            yield replace(shape, collides=True, surface=surface_of(compiled, g))
