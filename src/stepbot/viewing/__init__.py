"""A robot as one self-contained web page: the scene as JSON, and the page that draws it. For ``pipeline`` and above.

packing        triangle meshes as short text
scene          the robot: links, shapes, mass, frames, sensors
motion         what the page needs to move it: one-dof joints, loops, driven joints and their ranges
connections    joints and closures with their evidence, and marks where it is weak
findings       the verification table, overlapping links, diagnostics
components     the tree of the STEP file
guesses        the robot of a plain STEP file, with the joints of a draft and without masses
described      the robot of a URDF, SDFormat or MJCF file
faces          the axis of a clicked face
joining        the axes that two components share
page           HTML, style and scripts in one file

The page needs no server and no network. A server may send it another scene.
"""
