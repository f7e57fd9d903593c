"""Poses, triangle meshes and solids: each question about a shape is answered here, once.

Knows neither CAD nor robots; anyone above may import it.
"""
