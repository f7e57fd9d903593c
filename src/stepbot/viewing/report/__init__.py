"""The report of a conversion as one HTML file, and the index of a batch. For ``pipeline`` and ``jobs``.

markup        elements whose texts are escaped
numbers       quantities as a person reads them, with the exact value beside
reduction     meshes that are coarse enough for a page, and by how much they differ
plot          deviations of all checks against their tolerances
sections      joints, masses, verification, bodies, findings as tables
page          the robot that moves, and the sections below it
index         all robots of a batch
"""
