"""Links that overlap, by python-fcl: in the drawn pose, and in sampled configurations over the whole range.

The other rooms use :mod:`.worker`; the rest runs in its process.
"""
