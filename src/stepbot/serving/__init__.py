"""A robot's page with a server behind it, on this machine alone. For ``api`` and above.

local_server   HTTP on 127.0.0.1: one token, one origin, no files
session        what one page shows and asks: the scene, verification, faces, axes that parts share
edits          what a person does in the page, as changes of the sidecar: of joints, of the tree, of any value
described      edits of a sidecar that changes an existing description
decisions      what the sidecar states, and what is left to decide
editor         writes edits: checked, undone, redone
watching       shows a target again whenever one of its files is saved
"""
