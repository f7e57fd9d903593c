"""A sidecar with more misspelt keys than anyone reads."""

CONTENT = b"version: 1\n" + b"".join(b"k%d: 0\n" % n for n in range(5000))
