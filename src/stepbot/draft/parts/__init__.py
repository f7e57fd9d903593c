"""Parts, their names, roles and faces; axes and disjoint sets."""
