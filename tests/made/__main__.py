"""Prints what ``init`` finds in drawn mechanisms, kind by kind; ``--aside`` those that no rule was set on."""

from argparse import ArgumentParser

from .kinds import ASIDE, ASIDE_BOUGHT, ASIDE_LATER, ASIDE_LATEST, KINDS
from .recorded import record
from .scored import Result, drawn, scored


def main() -> None:
    """Draw and score."""
    parser = ArgumentParser(prog="python -m tests.made", description=__doc__)
    parser.add_argument("--kind", default="", help="only kinds whose name contains this")
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--aside", action="store_true")
    parser.add_argument("-v", "--verbose", action="store_true", help="each missed and each wrong joint")
    parser.add_argument("--record", action="store_true", help="instead, write the drafts that tests compare")
    chosen = parser.parse_args()
    if chosen.record:
        record()
        return
    whole = Result()
    print("| kind | found | merged | wrong, unmarked | wrong, REVIEW | volume | root |\n| --- |" + " --- |" * 6)
    for kind in KINDS:
        if chosen.kind not in kind or (kind in ASIDE | ASIDE_LATER | ASIDE_BOUGHT | ASIDE_LATEST) != chosen.aside:
            continue
        total = Result()
        for seed in range(chosen.seeds):
            one = scored(drawn(kind, seed))
            total.add(one)
            if chosen.verbose and (one.notes or one.volume < 0.99 or not one.roots):
                print(f"  {kind} {seed}: {one.row()}", *one.notes, sep="\n    ")
        print(f"| {kind} | {total.row()} |", flush=True)
        whole.add(total)
    print(f"| **all** | {whole.row()} |")


if __name__ == "__main__":
    main()
