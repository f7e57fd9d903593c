"""Pictures of robots and assemblies without a window: camera, ray casting, exploded views, labels.

Uses embreex, Pillow and scipy, the extra ``render``. Imported by ``pipeline``, the command line and the library.
"""
