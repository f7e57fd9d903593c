"""Small descriptions as modules: URDF files of boxes on joints."""

from xml.sax.saxutils import quoteattr


def link(name: str, mass: float = 1.0, more: str = "") -> str:
    """A link with a principal inertia of 0.01 to 0.03 kg m^2."""
    inertial = '<inertia ixx="0.01" iyy="0.02" izz="0.025" ixy="0.001" ixz="0.002" iyz="0.003"/>'
    com = '<origin xyz="0.01 0.02 0.03"/>'
    return f'<link name={quoteattr(name)}><inertial>{com}<mass value="{mass}"/>{inertial}</inertial>{more}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", **settings: str) -> str:
    """A joint; ``xyz``, ``rpy``, ``axis``, ``lower``, ``upper`` and ``mimic``, the leader with more attributes."""
    given = {"xyz": "0 0 0", "rpy": "0 0 0", "axis": "0 0 1", "lower": "-1", "upper": "2", **settings}
    ends = f"<parent link={quoteattr(parent)}/><child link={quoteattr(child)}/>"
    origin = f'<origin xyz="{given["xyz"]}" rpy="{given["rpy"]}"/>'
    limit = f'<limit lower="{given["lower"]}" upper="{given["upper"]}" effort="10" velocity="2"/>'
    moves = f'<axis xyz="{given["axis"]}"/>{limit}' if kind != "fixed" else ""
    follows = f"<mimic joint={given['mimic']}/>" if "mimic" in given else ""
    return f'<joint name={quoteattr(name)} type="{kind}">{ends}{origin}{moves}{follows}</joint>'


def urdf(name: str, *elements: str) -> str:
    """The URDF of links and joints."""
    return f'<robot name="{name}">{"".join(elements)}</robot>'


def box(x: float, y: float, z: float) -> str:
    """A box as visual and collision shape."""
    shape = f'<geometry><box size="{x} {y} {z}"/></geometry>'
    return f"<visual>{shape}</visual><collision>{shape}</collision>"


ARM = urdf("arm", link("base", 2.0), link("tip"), joint("lift", "base", "tip", xyz="0.1 0.2 0.3", axis="0 1 0"))
"""A base and a tip."""


def composing(*modules: str, more: str = "") -> str:
    """A sidecar of modules, each ``name: {...}``."""
    lines = "".join(f"  {module}\n" for module in modules)
    return f"version: 1\nrobot: whole\nbase: fixed\nmodules:\n{lines}{more}"
