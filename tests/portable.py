"""The tests that run in every Python: processes, types at run time, numbers, bytes, engines."""

PORTABLE = (
    "unit/geometry/test_enclosing_shapes.py",
    "unit/assemble/test_joints.py",
    "unit/assemble/test_mass.py",
    "unit/geometry/",
    "unit/robot/test_dynamics.py",
    "unit/robot/test_kinematics.py",
    "unit/runtime/cache/",
    "unit/runtime/test_fork_server.py",
    "unit/runtime/test_worker.py",
    "unit/runtime/test_parallel.py",
    "unit/verification/test_comparison.py",
    "conformance/",
    "cli/test_application.py",
)
"""Files and folders below tests/; `make wheels` runs them against the installed wheel."""
