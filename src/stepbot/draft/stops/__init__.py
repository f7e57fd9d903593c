"""Stops of drafted joints, found by collision."""
