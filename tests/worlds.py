"""Worlds of several models, read by engines; each function runs in a separate process."""


def drake_models(file: str) -> list[list[str]]:
    """Names of the links of each model in a world, sorted."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)
    models = Parser(plant).AddModels(file)
    return [sorted(plant.get_body(i).name() for i in plant.GetBodyIndices(model)) for model in models]


def pybullet_models(file: str) -> list[list[str]]:
    """Names of the links of each model in a world, sorted."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    found = []
    for body in pybullet.loadSDF(file):
        below = [pybullet.getJointInfo(body, i)[12].decode() for i in range(pybullet.getNumJoints(body))]
        found.append(sorted([pybullet.getBodyInfo(body)[0].decode(), *below]))
    return found
