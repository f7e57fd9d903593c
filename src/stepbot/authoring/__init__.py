"""A sidecar drafted from a plain STEP: links and joints inferred from contacts, roles and names.

Everything here is evidence, not knowledge: each line of a draft says what it was drafted from and how strong that is.
"""
