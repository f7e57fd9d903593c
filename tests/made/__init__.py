"""Assemblies that nobody tunes on: drawn at random from kinds of mechanisms, each with its truth.

``python -m tests.made [--kind X] [--aside] [--seeds N]`` prints what ``init`` finds in them. A third of the kinds,
``kinds.ASIDE``, was set aside by lot before any was drafted: rules are set while looking at the others alone.
"""
