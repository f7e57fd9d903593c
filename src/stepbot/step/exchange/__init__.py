"""The STEP file as text and entities: Part 21, strings, encodings, units, dangling references."""

DOCUMENT_FILE = b"DOCUMENT_FILE"
"""Contained in the text of every STEP file that refers to other files."""
