"""Damage to a sidecar: to its tree, which is changed in place, or to its text.

Each kind is a function whose only choices are those of a random generator. Replacements come from the sidecar itself,
from commonly confused words, and from special cases of YAML, units, paths and names.
"""

import copy
from collections.abc import Callable
from random import Random

from .sidecar_tree import Listing, Node, Scalar, Table, places, replace_value, values_of, written

TreeDamage = Callable[[Table, Random], None]

_NUMBERS = (
    "0", "-0.0", "1", "-1", "1e-300", "-1e-300", "1e300", "-1e300", "1e400", "5e-324", ".nan", "nan", ".inf", "-.inf",
    "inf", "-inf", "9" * 400, "0x7fffffffffffffff", "0o17", "1_000", "1,5", "1/3", "1e", "+-1", "٣", "１", "²", "12 mm",
    "-12 mm", "1e308 km", "-1e308 mm", "1e-320 nm", "0 deg", "1e9 rev", "-720 deg", "0.0000001 kg", "1e30 t", "-5 g",
    "100 %", "-3 %", "1e6 %", "0 kg/m^3", "-7 g/cm^3", "1e300 kg/m^3", "nan mm", "inf deg", ".nan kg",
)  # fmt: skip
_UNITS = (
    "mm", "m", "in", "deg", "rad", "rpm", "kg", "g", "N", "N*m", "Nm", "%", "s", "Hz", "kg/m^3", "deg/s", "m/s", "mm^2",
    "parsec", "", "µm", "μm", "°", "N*m*s/rad", "m^99", "m^-99", "m/m/m", "kg*", "/s", "*", "m^", "m^1e9", "m^m",
)  # fmt: skip
_TEXTS = (
    "''", '""', "' '", "x", "true", "yes", "null", "~", "[]", "{}", "[[]]", "{a: {b: []}}", "auto", "world", "assembly",
    "__model__", "a::b", "CON", "aux.obj", "..", ".", "../../x", "/etc/passwd", '"C:\\\\x"', '"a\\0b"', '"\\x1b[31m"',
    '"\\u202egnirts"', '"\\ud800"', '"\\U0010ffff"', "'<&\">'", "'%s%n'", "'{0}'", "naïve", "Ж", "\U0001f916",
    "!!python/object/apply:os.system [id]", "!!binary aGk=", "!!float x", "!x y", "*nothing", "&a", "&a 1", "|\n   x",
    "2026-11-22", "0b1", "1:30", "@x", "`x`", "%x", "? x", "- x", ": x", "#x", "'x", '"x', "[x", "{x", "x]",
)  # fmt: skip
_PATHS = (
    '"**"', '"*"', '"**/**"', '"***"', '"**/*/**/*/**/*/**/*/**/*"', '"' + "*a" * 40 + '"', '"' + "**/" * 200 + 'x"',
    '"a//b"', '"/"', '"."', '".."', '"a/../b"', '"\\\\"', '"\\\\*"', '"a\\\\"', '"#"', '"#0"', '"x#-1"',
    '"x#99999999999999999999"', '"x#1#2"', '"[a-z]"', '"(a+)+$"', '"a\\u0000"', '"' + "a/" * 5000 + 'a"', '"{a,b}"',
)  # fmt: skip
_KEYS = (
    "x", "Version", "links ", "''", "~", "true", "1", "1.5", "<<", "? a", "[a]", "{a: b}", "*x", "&x y", "!!str z",
    "__proto__", '"\\0"', '"\\u202e"', "limit", "lower", "upper", "parts", "rest", "inertial", "origin", "type",
    "parent", "child", "mass", "density", "color", "zero", "axis", "axis2", "pitch", "mimic", "joint", "link", "frame",
    "offset",
    "xyz", "rpy", "mate", "auto", "axis_of", "center", "radius", "near", "collision", "visual", "mesh", "Ж",
    "y" * 300,
)  # fmt: skip


def dropped(root: Table, rng: Random) -> None:
    """Remove keys and values."""
    for _ in range(rng.choice((1, 1, 2, 5))):
        container, index = _place(root, rng)
        del (container.pairs if isinstance(container, Table) else container.values)[index]
        if not root.pairs:
            return


def doubled(root: Table, rng: Random) -> None:
    """Duplicate keys and values, in place or further down."""
    container, index = _place(root, rng)
    values: list[object] = container.pairs if isinstance(container, Table) else container.values  # type: ignore[assignment]
    values.insert(rng.choice((index, index + 1, len(values))), copy.deepcopy(values[index]))


def renamed(root: Table, rng: Random) -> None:
    """Rename keys: misspelt, in other case, of another section, or no words at all."""
    tables = [container for container, _ in places(root) if isinstance(container, Table)] or [root]
    for _ in range(rng.choice((1, 1, 3))):
        table = rng.choice(tables)
        index = rng.randrange(len(table.pairs))
        key, value = table.pairs[index]
        names = [key for key, _ in rng.choice(tables).pairs]
        misspelt = (key[1:] + key[:1], key.upper(), key + "s", key[:-1] or "k", key + " ", f"'{key}'")
        table.pairs[index] = (rng.choice((*misspelt, *rng.sample(_KEYS, 3), rng.choice(names))), value)


def retyped(root: Table, rng: Random) -> None:
    """Change the type of a value: a list for a mapping, a text for a number, a mapping for a text."""
    container, index = _place(root, rng)
    value = values_of(container)[index]
    changed: tuple[Node, ...] = (
        Scalar(rng.choice(_TEXTS)),
        Scalar(rng.choice(_NUMBERS)),
        Listing([value]),
        Listing([value] * rng.choice((2, 3, 7))),
        Table([(rng.choice(_KEYS), value)]),
        Listing(values_of(value)),
        Table([(f"k{number}", one) for number, one in enumerate(values_of(value))]),
    )
    replace_value(container, index, rng.choice(changed))


def numbers(root: Table, rng: Random) -> None:
    """Replace numbers by huge, tiny, negative, infinite or non-numeric ones."""
    for container, index in _some(root, rng, _is_number):
        replace_value(container, index, Scalar(rng.choice(_NUMBERS)))


def units(root: Table, rng: Random) -> None:
    """Replace units by those of another quantity, none, or invalid ones."""
    for container, index in _some(root, rng, _is_number):
        value = values_of(container)[index]
        assert isinstance(value, Scalar)
        number = value.source.strip("\"'").split(" ")[0]
        replace_value(container, index, Scalar(f'"{number} {rng.choice(_UNITS)}"'))


def magnitudes(root: Table, rng: Random) -> None:
    """Multiply numbers by a power of ten, or change their sign; the units are right, so the result may build."""
    for container, index in _some(root, rng, _is_number):
        value = values_of(container)[index]
        assert isinstance(value, Scalar)
        number, blank, unit = value.source.strip("\"'").partition(" ")
        factor = rng.choice((-1.0, 0.0, 1e-12, 1e-3, 1e3, 1e6, 1e12, 1e100))
        replace_value(container, index, Scalar(f"{float(number) * factor!r}{blank}{unit}"))


def texts(root: Table, rng: Random) -> None:
    """Replace texts by empty, reserved, broken or foreign ones, or by code in another language."""
    for container, index in _some(root, rng, lambda value: isinstance(value, Scalar)):
        replace_value(container, index, Scalar(rng.choice(_TEXTS)))


def paths(root: Table, rng: Random) -> None:
    """Replace paths by ones that match nothing, everything, or take long to match."""
    if rng.random() < 0.5:
        tables = [value for key, value in root.pairs if key in ("parts", "joint_defaults") and isinstance(value, Table)]
        if tables and tables[0].pairs:
            index = rng.randrange(len(tables[0].pairs))
            tables[0].pairs[index] = (rng.choice(_PATHS), tables[0].pairs[index][1])
            return
    lists = [
        (value, index)
        for container, place in places(root)
        if isinstance(value := values_of(container)[place], Listing)
        for index, one in enumerate(value.values)
        if isinstance(one, Scalar) and not _is_number(one)
    ]
    if lists:
        container, index = rng.choice(lists)
        container.values[index] = Scalar(rng.choice(_PATHS))


def references(root: Table, rng: Random) -> None:
    """Redirect names: links become their own parents, joints follow each other in cycles."""
    names = [key for _, section in root.pairs if isinstance(section, Table) for key, _ in section.pairs]
    used = [
        (container, index)
        for container, index in places(root)
        if isinstance(value := values_of(container)[index], Scalar) and value.source in names
    ]
    for container, index in rng.sample(used, min(len(used), rng.choice((1, 1, 2, 4)))):
        replace_value(container, index, Scalar(rng.choice(names)))


def grafted(root: Table, rng: Random) -> None:
    """Replace a part of the sidecar by another part, which may contain it."""
    source, from_index = _place(root, rng)
    piece = copy.deepcopy(values_of(source)[from_index])
    container, index = _place(root, rng)
    replace_value(container, index, piece)


def nested(root: Table, rng: Random) -> None:
    """Nest a value in hundreds of others, or lengthen a list to thousands of values."""
    container, index = _place(root, rng)
    value = values_of(container)[index]
    depth = rng.choice((3, 16, 22, 30, 200))
    if rng.random() < 0.5:
        opened, closed = rng.choice((("[", "]"), ("{a: ", "}"), ("- ", "")))
        replace_value(container, index, Scalar(opened * depth * 5 + "1" + closed * depth * 5))
    elif rng.random() < 0.5:
        for _ in range(depth):
            value = Listing([value]) if rng.random() < 0.5 else Table([("a", value)])
        replace_value(container, index, value)
    else:
        replace_value(container, index, Listing([value] * rng.choice((100, 3000))))


def aliases(root: Table, rng: Random) -> None:
    """Add anchors, aliases and merges: of other parts, of themselves, exponentially many."""
    container, index = _place(root, rng)
    anchored = values_of(container)[index]
    if isinstance(anchored, Scalar):
        anchored.source = f"&a {anchored.source}"
    else:
        anchored.prefix = "&a"
    way = rng.randrange(4)
    other, at = _place(root, rng)
    if way == 0:
        replace_value(other, at, Scalar("*a"))
    elif way == 1 and isinstance(other, Table):
        other.pairs.insert(at, ("<<", Scalar(rng.choice(("*a", "[*a, *a]", "{x: *a}", "1", "*b")))))
    elif way == 2:
        bomb = [Scalar("&l0 [x, x, x, x, x, x, x, x]")]
        bomb += [Scalar(f"&l{n} [{', '.join([f'*l{n - 1}'] * 9)}]") for n in range(1, rng.choice((3, 9, 20)))]
        replace_value(other, at, Listing(list(bomb)))
    else:
        replace_value(other, at, Scalar("&s [*s, *s]"))


def _place(root: Table, rng: Random) -> tuple[Table | Listing, int]:
    found = list(places(root))
    if not found:
        root.pairs.append(("x", Scalar("1")))
        return root, 0
    return rng.choice(found)


def _some(root: Table, rng: Random, wanted: Callable[[Node], bool]) -> list[tuple[Table | Listing, int]]:
    found = [(container, index) for container, index in places(root) if wanted(values_of(container)[index])]
    return rng.sample(found, min(len(found), rng.choice((1, 1, 2, 6))))


def _is_number(node: Node) -> bool:
    if not isinstance(node, Scalar):
        return False
    try:
        float(node.source.strip("\"'").split(" ")[0])
    except ValueError:
        return False
    return True


def spoiled_text(text: str, rng: Random) -> bytes:
    """Damage bytes, indent by tabs, change line ends and encodings, or remove the end."""
    data = text.encode()
    cut = rng.randrange(len(data) + 1)
    lines = text.split("\n")
    line = rng.randrange(len(lines))
    way = rng.randrange(9)
    if way == 0:
        return data[:cut]
    if way == 1:
        return data[:cut] + rng.randbytes(rng.choice((1, 2, 8))) + data[cut:]
    if way == 2:
        flipped = bytearray(data)
        flipped[min(cut, len(data) - 1)] ^= 1 << rng.randrange(8)
        return bytes(flipped)
    if way == 3:
        lines[line] = lines[line].replace("  ", "\t")
    elif way == 4:
        lines[line] = " " * rng.choice((1, 3, 9)) + lines[line]
    elif way == 5:
        lines[line] = rng.choice(("---", "...", "%YAML 1.1", "%TAG ! x", "# x", "\ufeff", "<<<<<<< HEAD", "x" * 5000))
    elif way == 6:
        lines[line] = lines[line] + rng.choice(":-#'\"[]{}|>&*!%@`,?\\\x07\u2028\u200b\u202e\x85")
    elif way == 7:
        return rng.choice((text.encode("utf-16"), text.encode("utf-32"), text.replace("\n", "\r").encode()))
    else:
        rng.shuffle(lines)
    return "\n".join(lines).encode()


TREE_DAMAGE: dict[str, TreeDamage] = {
    "dropped": dropped,
    "doubled": doubled,
    "renamed": renamed,
    "retyped": retyped,
    "numbers": numbers,
    "units": units,
    "magnitudes": magnitudes,
    "texts": texts,
    "paths": paths,
    "references": references,
    "grafted": grafted,
    "nested": nested,
    "aliases": aliases,
}
KINDS = (*TREE_DAMAGE, "text", "mixed")


def damaged(base: Table, kind: str, rng: Random) -> bytes:
    """The bytes of a sidecar with damage of a kind; the tree itself is not changed."""
    root = copy.deepcopy(base)
    if kind == "text":
        return spoiled_text(written(root), rng)
    kinds = [kind] if kind != "mixed" else rng.choices(list(TREE_DAMAGE), k=rng.choice((2, 3, 5)))
    kinds.sort(key=lambda one: one == "nested")  # last: the others copy trees, and Python's copy is recursive
    for one in kinds:
        TREE_DAMAGE[one](root, rng)
    text = written(root)
    return spoiled_text(text, rng) if kind == "mixed" and rng.random() < 0.3 else text.encode("utf-8", "surrogatepass")
