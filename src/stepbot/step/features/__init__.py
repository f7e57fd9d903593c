"""Features of bodies from which joints are found: cylindrical and conical faces, and their axis lines."""
