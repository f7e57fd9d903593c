"""STEP files of a few kilobytes that expand to millions of occurrences: assemblies that share assemblies."""

import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from tests.conftest import ROOT

from .command import stepbot
from .experiment import Experiment, Setting, Trial

CASES = ((8, 10, True), (30, 2, True), (3, 1100, True), (3, 10, False))
"""Levels, occurrences per level, whether the tree is beyond stepbot's limit."""
LONGEST = 60.0
"""Seconds within which too large a tree is rejected."""
MEMORY = "2G"
"""Memory within which it is rejected."""


def run(setting: Setting) -> Iterator[Trial]:
    """Inspect each tree; those that are too large are rejected in bounded time and memory."""
    for levels, children, is_refused in CASES[: setting.count]:
        name = f"{children}^{levels}"
        place = setting.folder / name
        place.mkdir()
        step = place / "tree.step"
        command = [sys.executable, "-m", "tests.hostile.trees", str(step), str(levels), str(children)]
        subprocess.run(command, cwd=ROOT, check=True)
        began = time.monotonic()
        options = ("--memory-limit", MEMORY, "--no-cache", "--json")
        ended = stepbot("inspect", step, *options, folder=place, temporary=place / "tmp")
        faults = list(ended.faults((1,) if is_refused else (0,)))
        if is_refused and "SB215" not in ended.text:
            faults.append(f"SB215 is not reported\n{ended.text[-1000:]}")
        if is_refused and time.monotonic() - began > LONGEST:
            faults.append(f"takes {time.monotonic() - began:.0f} s")
        yield Trial(name, "refused" if ended.code else "read", tuple(faults))


def write_tree(path: Path, levels: int, children: int) -> None:
    """Write a box that is in an assembly ``children`` times, which is in an assembly ``children`` times, and so on.

    Written as text, because the kernel would expand every occurrence.
    """
    from tests.parts import write_box

    write_box(path)
    text = path.read_text(encoding="ascii")
    text = text[: text.rindex("ENDSEC;")]
    numbers = iter(range(1_000_000, 2_000_000))
    lines: list[str] = []

    def add(content: str) -> str:
        number = next(numbers)
        lines.append(f"#{number}={content};")
        return f"#{number}"

    product_context, definition_context = _number(text, "PRODUCT_CONTEXT"), _number(text, "PRODUCT_DEFINITION_CONTEXT")
    items = re.search(r"ADVANCED_BREP_SHAPE_REPRESENTATION\('',\((#\d+),.*?\),(#\d+)\)", text)
    assert items is not None
    placement, context = items.groups()
    definition, shown = _number(text, "PRODUCT_DEFINITION"), _number(text, "ADVANCED_BREP_SHAPE_REPRESENTATION")
    for level in range(levels):
        product = add(f"PRODUCT('level {level}','level {level}','',({product_context}))")
        formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        above = add(f"PRODUCT_DEFINITION('design','',{formation},{definition_context})")
        points = [add(f"CARTESIAN_POINT('',({2.0 * n},{3.0 * level},0.))") for n in range(children)]
        places = [add(f"AXIS2_PLACEMENT_3D('',{point},$,$)") for point in points]
        whole = add(f"SHAPE_REPRESENTATION('',({','.join([placement, *places])}),{context})")
        shape = add(f"PRODUCT_DEFINITION_SHAPE('','',{above})")
        add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{whole})")
        for n, place in enumerate(places):
            usage = add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{level}.{n}','l{level}:{n}','',{above},{definition},$)")
            moved = add(f"ITEM_DEFINED_TRANSFORMATION('','',{placement},{place})")
            related = add(
                f"( REPRESENTATION_RELATIONSHIP('','',{shown},{whole})"
                f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({moved})SHAPE_REPRESENTATION_RELATIONSHIP() )"
            )
            placed = add(f"PRODUCT_DEFINITION_SHAPE('','',{usage})")
            add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({related},{placed})")
        definition, shown = above, whole
    path.write_text("\n".join([text, *lines, "ENDSEC;", "END-ISO-10303-21;", ""]), encoding="ascii")


def _number(text: str, keyword: str) -> str:
    found = re.search(rf"(#\d+)\s*=\s*{keyword}\(", text)
    assert found is not None, keyword
    return found[1]


EXPERIMENT = Experiment(
    "trees",
    "STEP files of a few kilobytes whose assemblies share assemblies: 100 million occurrences and more",
    "SB215 with the number, within a minute and 2 GB",
    run,
    short=1,
    long=len(CASES),
    repaired=(
        "a STEP file of 50 kB that stands for 111,111,111 occurrences kept the kernel until `--timeout` (SB215)",
    ),
)

if __name__ == "__main__":
    write_tree(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
