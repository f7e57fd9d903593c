"""Selects what to convert: one robot unless it is unchanged, many in a batch, files that are out of date.

May be called by the API and the command line.
"""
