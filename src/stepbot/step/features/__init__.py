"""Features of bodies that joints are found from: cylindrical and conical faces, and the axis lines that they share."""
