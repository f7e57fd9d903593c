"""Gymnasium environments from a robot's MJCF: its actuators are the actions, its joints and sensors the observations.

Importing this package registers ``stepbot/Reach-v0`` and ``stepbot/Stand-v0`` (``docs/use-it-in.md``). It needs
gymnasium, which ``pip install 'stepbot[learn]'`` adds; nothing else of stepbot imports it.

:mod:`.model` loads a file, :mod:`.controls` turns actions into controls, :mod:`.observations` gathers what is observed,
:mod:`.configurations` draws random ones that the robot can take, :mod:`.environment` puts them together, :mod:`.tasks`
add targets and rewards.
"""

from os import PathLike
from typing import Any

try:
    import gymnasium
except ImportError as error:
    raise ImportError("stepbot.gym needs gymnasium: pip install 'stepbot[learn]'") from error

from .model import load

TASKS = {"reach": "stepbot/Reach-v0", "stand": "stepbot/Stand-v0"}
"""Names that :func:`make` takes, and the names under which gymnasium has the environments."""

gymnasium.register(TASKS["reach"], entry_point=f"{__name__}.tasks:Reach", max_episode_steps=75)
gymnasium.register(TASKS["stand"], entry_point=f"{__name__}.tasks:Stand", max_episode_steps=250)


def make(model: "str | PathLike[str] | Any", task: str = "reach", **options: Any) -> Any:
    """Make an environment: ``gymnasium.make`` with the name of a task.

    Args:
        model: An MJCF file, or a model that :func:`load` returned.
        task: ``reach`` or ``stand``.
        options: Arguments of :class:`.tasks.Reach` or :class:`.tasks.Stand`, and those of ``gymnasium.make``.

    Raises:
        ValueError: There is no such task, or the robot cannot do it.
    """
    if task not in TASKS:
        raise ValueError(f"unknown task '{task}'; there are {', '.join(TASKS)}")
    return gymnasium.make(TASKS[task], model=model, **options)


__all__ = ["TASKS", "load", "make"]
