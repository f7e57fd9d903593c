"""The robot as plain data, SI, independent of formats; kinematics, dynamics, loop closures and validity rules.

May be imported by any room above; imports only geometry, runtime and diagnostics.
"""
