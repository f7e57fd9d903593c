"""A robot's page with a server behind it, on this machine alone. For ``api`` and above.

local_server   HTTP on 127.0.0.1: one token, one origin, no files
session        what one page shows and asks: the scene, verification, faces
"""
