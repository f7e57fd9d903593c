"""Runs one conversion, from a sidecar and a STEP file to written and verified files.

:mod:`.stages` is the pipeline as one function. May be called by ``jobs`` and the API.
"""
