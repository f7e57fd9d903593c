"""Variants of a sidecar and overrides of a module: one tree of values merged into another, before validation.

Every value keeps the place where it is written, so that an error in a merged sidecar points into the right file.
"""

from collections.abc import Iterator
from pathlib import Path

from ruamel.yaml.error import YAMLError

from stepbot.diagnostics import Diagnostics, did_you_mean

from .compose import TooMuchError, compose
from .tree import ELEMENTS, Entry, Keys, Listing, Mapping, Scalar, Tree, child, entries_of, span, way

_NAMED = (*ELEMENTS, "modules")
"""Sections whose members `without` and `set` name."""
_PARTS = ("links", "modules")
OWN_KEYS = ("like", "without")
"""Keys of a variant that are none of a sidecar."""
_WHOLE = ("inertia",)
"""Keys of mappings that are one value: the products of another inertia mean nothing beside new moments."""
_OF_FILE = ("by", "home", "set", "without", "variant", "rename", "flip")
"""Keys of a module that name elements of its file, and go with it."""


def variant_names(text: str) -> tuple[str, ...]:
    """The names of the variants in a sidecar's text; empty if it has none or is no valid YAML."""
    try:
        root = compose(text, "", Diagnostics())
    except (YAMLError, TooMuchError):
        return ()
    return tuple(entries_of(child(root, "variants"))) if root is not None else ()


def merged(base: Tree, patch: Tree, keys: Keys = ()) -> Tree:
    """The base with the values of the patch, which are at ``keys``: mappings are merged, everything else is replaced.

    A null drops the key; in `set` of a module that does not have it, that of the module. An inertia is one value. A
    module that gets another file keeps nothing that names elements of the former one.
    """
    if not (isinstance(base, Mapping) and isinstance(patch, Mapping)):
        return patch
    entries = dict(base.entries)
    for key, new in patch.entries.items():
        old = entries.get(key)
        if _is_null(new.value) and (old is not None or not _is_of_module(keys)):
            entries.pop(key, None)
        elif old is None or key in _WHOLE:
            empty = _mapping(new.value, {}) if isinstance(new.value, Mapping) else new.value
            entries[key] = Entry(new.key_span, merged(empty, new.value, (*keys, key)))
        else:
            value = _with_other_files(old.value, new.value) if key == "modules" else old.value
            entries[key] = Entry(old.key_span, merged(value, new.value, (*keys, key)))
    return _mapping(base, entries)


def _is_null(tree: Tree) -> bool:
    return isinstance(tree, Scalar) and tree.value is None and not tree.faulty


def _is_of_module(keys: Keys) -> bool:
    """Whether what is at ``keys`` is about keys of a module's file."""
    return keys[:1] == ("modules",) and keys[2:3] == ("set",)


def report_undropped(base: Tree | None, patch: Tree, who: str, diagnostics: Diagnostics, keys: Keys = ()) -> None:
    """Report SB160: nulls of a patch for keys that the base does not have."""
    known = entries_of(base)
    for key, entry in entries_of(patch).items():
        if not _is_null(entry.value):
            below = known[key].value if key in known else None
            report_undropped(below, entry.value, who, diagnostics, (*keys, key))
        elif key not in known and not _is_of_module(keys):
            help = (*did_you_mean(key, known), "remove it")
            diagnostics.add("SB160", f"{who}: no key '{key}' to drop", entry.key_span, help=help)


def _with_other_files(modules: Tree, patch: Tree) -> Tree:
    """The modules without what goes with the file of those that get another one."""
    if not (isinstance(modules, Mapping) and isinstance(patch, Mapping)):
        return modules
    entries = dict(modules.entries)
    for name in (entry for entry in patch.entries if entry in entries):
        module = entries[name]
        files = [one for tree in (modules, patch) for one in way(tree, (name, "file"))[2:]]
        if len({file.text for file in files if isinstance(file, Scalar)}) > 1 and isinstance(module.value, Mapping):
            kept = {key: entry for key, entry in module.value.entries.items() if key not in _OF_FILE}
            entries[name] = Entry(module.key_span, _mapping(module.value, kept))
    return _mapping(modules, entries)


def with_variant(root: Mapping, name: str, diagnostics: Diagnostics, module: Tree | None = None) -> Mapping | None:
    """The sidecar as its variant; None after SB160.

    Args:
        name: The variant. The robot of ``arm`` is named ``arm_<name>`` if the variant does not name it.
        diagnostics: Receives SB160: an unknown variant, a circular ``like``, an unknown name in ``without``.
        module: The module of another file that selects it.
    """
    patches = _patches(root, name, diagnostics, module)
    if patches is None:
        return None
    whole = root
    for patch in patches:
        entries = {key: entry for key, entry in patch.entries.items() if key not in OWN_KEYS}
        report_undropped(whole, _mapping(patch, entries), f"variant '{name}'", diagnostics)
        with_values = merged(whole, _mapping(patch, entries))
        assert isinstance(with_values, Mapping)
        whole = _without(with_values, child(patch, "without"), f"variant '{name}'", diagnostics)
    if any(_names(root, section) for section in _PARTS) and not any(_names(whole, section) for section in _PARTS):
        help = ("leave out what is attached alone: without the part below it, it goes too",)
        _report(
            diagnostics,
            root,
            ("variants", name, "without"),
            f"variant '{name}': without: no link or module is left",
            help,
        )
        return None
    robot = root.entries.get("robot")
    if robot is not None and isinstance(robot.value, Scalar) and child(whole, "robot") is robot.value:
        named = f"{robot.value.text}_{name}"
        value = Scalar(robot.value.span, named, named, robot.value.plain, robot.value.faulty)
        whole = _mapping(whole, {**whole.entries, "robot": Entry(robot.key_span, value)})
    return whole


def unknown_elements(root: Tree, patch: Tree) -> Iterator[tuple[tuple[str, str], tuple[str, ...]]]:
    """The elements of a patch that the sidecar does not have, each with the names that it has in this section."""
    for section in _NAMED:
        known = tuple(entries_of(child(root, section)))
        yield from (((section, name), known) for name in entries_of(child(patch, section)) if name not in known)


def _patches(root: Mapping, name: str, diagnostics: Diagnostics, module: Tree | None) -> list[Mapping] | None:
    """The patches of a variant in the order in which they are merged: first that of the one that it is like."""
    variants = child(root, "variants")
    known = tuple(entries_of(variants))
    patches: list[Mapping] = []
    chain: list[str] = []
    keys: Keys = ("variants",)
    while name:
        if name in chain:
            ring = " -> ".join([*chain[chain.index(name) :], name])
            _report(diagnostics, root, keys, f"variant '{chain[-1]}': like: circular: {ring}", ("remove one `like`",))
            return None
        if name not in known:
            listed = ", ".join(known)
            help = (*did_you_mean(name, known), f"variants: {listed}" if known else "add it under `variants`")
            message = f"no variant '{name}'"
            if module is not None and not chain:
                message = f"variant: {message} in '{Path(root.span.file).name}'"
                _report(diagnostics, module, ("variant",), message, help)
            else:
                subject = f"variant '{chain[-1]}': like" if chain else "sidecar"
                _report(diagnostics, root, keys, f"{subject}: {message}", help)
            return None
        chain.append(name)
        patch = child(variants, name) if variants is not None else None
        if patch is not None and patch.faulty:
            return None
        if not isinstance(patch, Mapping):
            _report(
                diagnostics, root, ("variants", name), f"variant '{name}': not a mapping", ("`NAME: {KEY: VALUE}`",)
            )
            return None
        if "variants" in patch.entries:
            help = ("add it beside this one: `like` starts from another variant",)
            _report(
                diagnostics,
                root,
                ("variants", name, "variants"),
                f"variant '{name}': a variant cannot have `variants`",
                help,
            )
            return None
        patches.insert(0, patch)
        keys = ("variants", name, "like")
        like = child(patch, "like")
        if like is not None and not isinstance(like, Scalar):
            _report(diagnostics, root, keys, f"variant '{name}': like: not the name of a variant", ())
            return None
        name = "" if like is None else str(like.value)
    return patches


def _report(diagnostics: Diagnostics, root: Tree, keys: Keys, message: str, help: tuple[str, ...]) -> None:
    diagnostics.add("SB160", message, span(root, keys), help=help)


def _without(root: Mapping, named: Tree | None, who: str, diagnostics: Diagnostics) -> Mapping:
    """The sidecar without some elements, everything attached to them, and the devices on what is left out."""
    if named is None:
        return root
    if not isinstance(named, Listing) or not all(isinstance(one, Scalar) for one in named.values):
        diagnostics.add("SB160", f"{who}: without: not a list of names", named.span, help=("`without: [NAME, ...]`",))
        return root
    known = {name for section in _NAMED for name in _names(root, section)}
    gone = set()
    for one in named.values:
        name = str(one.value) if isinstance(one, Scalar) else ""
        gone.add(name)
        if name not in known:
            message = f"{who}: without: no element '{name}'"
            diagnostics.add("SB160", message, one.span, help=did_you_mean(name, sorted(known)))
    left = _Left(root, gone)
    entries = {
        key: Entry(entry.key_span, _kept(entry.value, left.out[key])) if key in left.out else entry
        for key, entry in root.entries.items()
    }
    pairs = entries.get("excluded_contacts")
    if pairs is not None and isinstance(pairs.value, Listing):
        stay = [one for one in pairs.value.values if not any(left.is_out(text) for text in _texts(one))]
        value = Listing(pairs.value.span, stay, pairs.value.size, pairs.value.depth, pairs.value.flow)
        entries["excluded_contacts"] = Entry(pairs.key_span, value)
    return _mapping(root, entries)


class _Left:
    """What is left out with some elements: what hangs on them, and what refers to them."""

    def __init__(self, root: Mapping, names: set[str]) -> None:
        self.out = {section: {name for name in _names(root, section) if name in names} for section in _NAMED}
        before = -1
        while before != (before := sum(map(len, self.out.values()))):
            self._spread(root)

    def is_out(self, reference: str) -> bool:
        """Whether a link, frame or module, or what is in it, is left out."""
        name = reference.partition("/")[0]
        return any(name in self.out[section] for section in ("links", "frames", "modules"))

    def _spread(self, root: Mapping) -> None:
        for name, joint in _members(root, "joints"):
            if name in self.out["joints"] or self.is_out(_text(joint, "parent")) or self.is_out(_text(joint, "child")):
                self.out["joints"].add(name)
                moved = _text(joint, "child").partition("/")[0]
                for section in ("links", "modules"):
                    self.out[section] |= {moved} & _names(root, section)
        for section, keys in (
            ("frames", ("link",)),
            ("closures", ("link_a", "link_b")),
            ("modules", ("at", "mirror_of")),
            ("sensors", ("link",)),
        ):
            for name, member in _members(root, section):
                if any(self.is_out(_text(member, key)) for key in keys):
                    self.out[section].add(name)
        for section in ("actuators", "sensors"):
            for name, member in _members(root, section):
                driven = _text(member, "joint")
                if driven in self.out["joints"] or ("/" in driven and self.is_out(driven)):
                    self.out[section].add(name)


def _names(root: Mapping, section: str) -> set[str]:
    return set(entries_of(child(root, section)))


def _members(root: Mapping, section: str) -> Iterator[tuple[str, Tree]]:
    return ((name, entry.value) for name, entry in entries_of(child(root, section)).items())


def _text(tree: Tree, key: str) -> str:
    value = child(tree, key)
    return value.text if isinstance(value, Scalar) else ""


def _texts(tree: Tree) -> list[str]:
    return [value.text for value in tree.values if isinstance(value, Scalar)] if isinstance(tree, Listing) else []


def _kept(section: Tree, out: set[str]) -> Tree:
    if not isinstance(section, Mapping) or not out:
        return section
    return _mapping(section, {name: entry for name, entry in section.entries.items() if name not in out})


def _mapping(like: Mapping, entries: dict[str, Entry]) -> Mapping:
    size = 1 + sum(entry.value.size for entry in entries.values())
    depth = 1 + max((entry.value.depth for entry in entries.values()), default=0)
    return Mapping(like.span, entries, size, depth)
