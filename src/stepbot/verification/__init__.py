"""Compares the observations of engines with the robot, or with each other. May be called by ``pipeline`` and above.

One comparison serves all formats and engines (:mod:`.compare`), with one table of tolerances (:mod:`.deviation`).
Written files are compared with their robot (:mod:`.conversion`); any files with each other (:mod:`.files`). Nothing is
imported here: the processes of engines need a part of this room alone.
"""
