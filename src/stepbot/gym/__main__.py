"""``python -m stepbot.gym MODEL``: train a linear policy for a robot, print its curve and draw it."""

import argparse
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from . import make
from .training import PLANS, draw, rise, shortened, train


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code: 0, or 2 if it could not run."""
    options = argument_parser().parse_args(arguments)
    plan = shortened(PLANS[options.task], options.iterations, options.seed)
    plan = replace(plan, options={**plan.options, **options.option}, inputs=tuple(options.input) or plan.inputs)
    plan = replace(plan, outputs=tuple(options.output) or plan.outputs)
    if options.plot and find_spec("matplotlib") is None:
        sys.stderr.write("error: --plot needs matplotlib: pip install 'stepbot[learn]'\n")
        return 2
    start, scores = time.monotonic(), []
    try:
        if options.task == "reach":
            environment = make(options.model, "reach", disable_env_checker=True, **plan.options).unwrapped
            sys.stdout.write(f"tip: {environment.tip_name}\n")
        for score in train(options.model, plan, processes=options.processes):
            scores.append(score)
            sys.stdout.write(f"{score}, {time.monotonic() - start:.0f} s\n")
            sys.stdout.flush()
        gained, margin = rise(scores[0], scores[-1])
        sys.stdout.write(f"return of the same episodes: {gained:+.1f} +- {margin:.1f}\n")
        if options.plot:
            draw(scores, f"{options.task}: {Path(options.model).stem}", options.plot)
    except (OSError, TypeError, ValueError, ImportError) as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    return 0


def argument_parser() -> argparse.ArgumentParser:
    """The command's arguments."""
    parser = argparse.ArgumentParser(prog="python -m stepbot.gym", description=__doc__.partition(": ")[2])
    parser.add_argument("model", metavar="MODEL", help="MJCF file, as ur5e/ur5e.xml")
    parser.add_argument("--task", choices=sorted(PLANS), default="reach", help="[default: reach]")
    parser.add_argument("--iterations", type=int, metavar="N", help="[default: that of the task]")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="[default: 2]; the results are the same")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="[default: 0]")
    parser.add_argument(
        "--input",
        action="append",
        default=[],
        metavar="PATTERN",
        help="pattern of observations that the policy sees",
    )
    parser.add_argument(
        "--output", action="append", default=[], metavar="PATTERN", help="pattern of actions that it decides"
    )
    parser.add_argument(
        "--option", type=_option, action=_Options, default={}, metavar="NAME=JSON", help="argument of the environment"
    )
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the curve, as SVG or PNG")
    return parser


def _option(text: str) -> tuple[str, object]:
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=JSON, as spread=0.1")
    try:
        return name, json.loads(value)
    except json.JSONDecodeError:
        return name, value


class _Options(argparse.Action):
    """Collects ``NAME=JSON`` in a dictionary."""

    def __call__(self, _parser: object, namespace: argparse.Namespace, value: object, _name: object = None) -> None:
        assert isinstance(value, tuple)
        setattr(namespace, self.dest, {**getattr(namespace, self.dest), value[0]: value[1]})


if __name__ == "__main__":
    sys.exit(main())
