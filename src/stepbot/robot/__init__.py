"""The robot as plain data, SI, free of any format, and its mechanics: kinematics, dynamics, loop closures, validity.

Anyone above may import it; it imports geometry, runtime and diagnostics alone.
"""
