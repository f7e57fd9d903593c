"""Macros of ROS, expanded by the package ``xacro`` in a process that foreign expressions cannot leave.

A xacro holds Python expressions, and names files to include. Here expressions cannot reach anything but numbers, texts,
lists and xacro's own functions, files are read in the package of the xacro and in packages that the user names, and the
environment is empty.
"""
