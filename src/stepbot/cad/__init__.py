"""STEP -> Assembly: the only package that imports the geometry kernel, and only in a worker process."""
