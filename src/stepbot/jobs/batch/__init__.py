"""Converts many robots on all cores or on a cluster, independently, and only those whose input has changed."""
