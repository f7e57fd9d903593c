"""Drafts a sidecar from a plain STEP: links and joints inferred from contacts, roles and names.

Every result is a guess with evidence: each line of a draft states its source and the strength of the evidence. May be
called by ``pipeline`` and above.
"""
