"""The files that make a folder with a URDF and its meshes a ROS 2 package: xacro, launch file, settings of MoveIt.

https://docs.ros.org/en/jazzy/How-To-Guides/Ament-CMake-Documentation.html
"""
