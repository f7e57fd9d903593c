"""What to convert: one robot unless it is unchanged, many in a batch, which files are up to date.

The command line calls this room.
"""
