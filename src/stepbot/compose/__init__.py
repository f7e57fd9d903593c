"""Composes robots of other robots: pure functions from robots to one robot.

changing     the robot of a description with changed names and values
parts        a module as it enters the composition: links left out, mirrored, in its initial pose, with its prefix
ports        links and frames that modules are attached to, by their references
placing      where each part is attached: one root, everything else on a port or below a joint
joining      the parts as one robot, with the joints, closures and devices between them
interfaces   parts that both sides of a mount have
mirroring    the mirror image of a robot
pruning      a robot without some of its links, joints and devices
"""
