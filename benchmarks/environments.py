"""Steps per second of processor time of environments of ``stepbot.gym``, one and several in one process."""

from collections.abc import Iterator
from pathlib import Path
from time import process_time

COUNTS = (1, 16)


def environment_speeds(model: Path, task: str, seconds: float = 3.0) -> Iterator[str]:
    """For each number of environments a line with the steps of all of them per second, for random actions."""
    import gymnasium

    import stepbot.gym

    compiled = stepbot.gym.load(model)
    for count in COUNTS:
        envs = gymnasium.make_vec(
            stepbot.gym.TASKS[task], num_envs=count, vectorization_mode="sync", model=compiled, observe="state"
        )
        envs.reset(seed=0)
        envs.action_space.seed(0)
        envs.step(envs.action_space.sample())
        steps, start = 0, process_time()
        while process_time() - start < seconds:
            envs.step(envs.action_space.sample())
            steps += count
        rate = steps / (process_time() - start)
        skipped = envs.envs[0].unwrapped.frame_skip
        yield f"{model.stem}, {task}, {count:2d} environments: {rate:.0f} steps/s, {rate * skipped:.0f} of MuJoCo's"
        envs.close()
