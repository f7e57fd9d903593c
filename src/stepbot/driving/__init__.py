"""Drive tests: a robot's files, moved by their actuators in MuJoCo and PyBullet.

May be called by ``pipeline`` and above.

:mod:`.mechanism` finds motors, wheels, fingers and limbs in the model, :mod:`.plan` decides which tests apply,
:mod:`.survey` chooses poses without contact, :mod:`.experiments` has the tests, and :mod:`.judgement`
compares their numbers with :mod:`.limits`.
"""
