"""An existing URDF, SDFormat or MJCF as the source of a robot: Description to Robot, with what the model cannot hold.

Where a STEP file and a sidecar are assembled, a description only needs to be put into the model's form: one joint above
each link, each link's frame in its joint, each mesh an asset. Physics is taken as given, and every deviation is listed.
"""
