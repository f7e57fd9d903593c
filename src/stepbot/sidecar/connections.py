"""Check that the joints connect all links to one tree."""

from collections.abc import Mapping
from itertools import count

from stepbot.diagnostics import Diagnostic, Diagnostics

from .located import Sidecar


def check_connections(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB450: self-connections, two parents, cycles, disconnected links, an invalid root.

    A joint with a wrong child leaves one link without a parent, so that this many disconnected links are notes of
    SB450 instead of an error of their own.
    """
    above, misplaced = _joint_above_each_link(sidecar)
    joints = sidecar.document.joints
    cycles = [ring[::-1] for ring in rings({link: joints[joint].parent for link, joint in above.items()})]
    for cycle in cycles:
        _report_cycle(sidecar, cycle, above, diagnostics)
    _check_root(sidecar, above, {link for cycle in cycles for link in cycle}, diagnostics)
    root, loose = _disconnected(sidecar, above)
    consequences = [f"not connected to the root '{root}': link '{link}'" for link in loose]
    explained = len(loose) <= len(misplaced)
    for one in misplaced:
        notes = (*one.notes, *consequences) if explained else one.notes
        diagnostics.add(one.code, one.message, one.span, help=one.help, notes=notes)
    for link in () if explained else loose:
        message = f"link '{link}': not connected to the root '{root}'"
        diagnostics.add(
            "SB450:disconnected", message, sidecar.key_span("links", link), help=_ways_to_connect(sidecar, link, root)
        )


def _joint_above_each_link(sidecar: Sidecar) -> tuple[dict[str, str], list[Diagnostic]]:
    """The parent joint of each link, the first one in the file; SB450 of the other joints."""
    above: dict[str, str] = {}
    diagnostics = Diagnostics()
    for name, joint in sidecar.document.joints.items():
        if joint.parent == joint.child:
            message = f"joint '{name}': parent and child are both '{joint.child}'"
            help = ["change parent or child to another link"]
            diagnostics.add("SB450", message, sidecar.span("joints", name, "child"), help=help)
        elif joint.child in above:
            other = above[joint.child]
            help = ["to close a loop, move the joint to `closures`, with `link_a` and `link_b`"]
            notes = [f"joint '{other}' at {sidecar.span('joints', other, 'child')}"]
            message = f"joint '{name}': link '{joint.child}' is already the child of joint '{other}'"
            diagnostics.add("SB450", message, sidecar.span("joints", name, "child"), help=help, notes=notes)
        else:
            above[joint.child] = name
    return above, list(diagnostics)


def rings(successor: Mapping[str, str]) -> list[list[str]]:
    """The cycles of a functional graph, each in the order of its successors."""
    cycles: list[list[str]] = []
    done: set[str] = set()
    for start in successor:
        path: list[str] = []
        name = start
        while name not in done and name in successor:
            done.add(name)
            path.append(name)
            name = successor[name]
        if name in path:
            cycles.append(path[path.index(name) :])
    return cycles


def _report_cycle(sidecar: Sidecar, cycle: list[str], above: dict[str, str], diagnostics: Diagnostics) -> None:
    order = list(sidecar.document.joints)
    last = max((above[link] for link in cycle), key=order.index)  # the last one in the file most likely closes it
    child = sidecar.document.joints[last].child
    at = cycle.index(child)
    ring = " -> ".join([*cycle[at:], *cycle[:at], child])
    help = ["swap parent and child of a joint, or move the joint that closes a loop to `closures`"]
    diagnostics.add(
        "SB450", f"joint '{last}': cycle in the joint tree: {ring}", sidecar.key_span("joints", last), help=help
    )


def _check_root(sidecar: Sidecar, above: dict[str, str], in_cycles: set[str], diagnostics: Diagnostics) -> None:
    document = sidecar.document
    root = document.root.link if document.root is not None else None
    if root is not None and root in above and root not in in_cycles:
        joint = above[root]
        message = f"root: link '{root}' is the child of joint '{joint}'"
        help = [f"the root of its tree is link '{top}'" for top in _tops(sidecar, above, root)]
        diagnostics.add("SB450", message, sidecar.span("root", "link"), help=help)


def _disconnected(sidecar: Sidecar, above: dict[str, str]) -> tuple[str, list[str]]:
    """The root, and the other links without a parent."""
    document = sidecar.document
    roots = [link for link in document.links if link not in above]
    misspelt = any(joint.child not in document.links for joint in document.joints.values())
    if len(roots) < 2 or misspelt:  # a link that a misspelt child refers to is not a root
        return "", []
    root = document.root.link if document.root is not None else None
    if root not in roots:
        counts = _counts_below(sidecar, roots)
        root = max(roots, key=lambda link: counts[link])
    return root, [link for link in roots if link != root]


def _ways_to_connect(sidecar: Sidecar, link: str, root: str) -> list[str]:
    """Lines to paste into ``joints``."""
    document = sidecar.document
    taken = {*document.links, *document.joints, *document.closures, *document.frames}
    joint = next(name for n in count(1) if (name := f"{link}_joint{n if n > 1 else ''}") not in taken)
    ends = f"parent: {root}, child: {link}"
    return [
        f"for a rigid connection to '{root}', add to `joints`: `{joint}: {{type: fixed, {ends}}}`",
        f"for a rotating joint: `{joint}: {{type: revolute, {ends}, limits: {{lower: -90 deg, upper: 90 deg}}}}`",
        "or assign its components to another link",
    ]


def _tops(sidecar: Sidecar, above: dict[str, str], link: str) -> list[str]:
    """The root of a link's tree; empty if the path upwards ends in a cycle."""
    passed = set()
    while link in above and link not in passed:
        passed.add(link)
        link = sidecar.document.joints[above[link]].parent
    return [] if link in passed else [link]


def _counts_below(sidecar: Sidecar, roots: list[str]) -> dict[str, int]:
    """Number of links below each of the roots."""
    below: dict[str, list[str]] = {}
    for joint in sidecar.document.joints.values():
        below.setdefault(joint.parent, []).append(joint.child)
    counts = {}
    for root in roots:
        reached, waiting = {root}, [root]
        while waiting:
            new = [child for child in below.get(waiting.pop(), []) if child not in reached]
            reached.update(new)
            waiting += new
        counts[root] = len(reached)
    return counts
