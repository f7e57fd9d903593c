"""Verification results for people and programs: ``report.json`` and JUnit XML.

May be called by ``verification`` and everything above it; independent of formats and engines.
"""
