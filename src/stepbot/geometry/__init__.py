"""Poses, triangle meshes and solids: each question about a shape is answered here, once.

Independent of CAD and robots; any room above may import it.
"""
