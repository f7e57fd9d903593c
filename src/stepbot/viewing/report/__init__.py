"""The report of a conversion as one HTML file, and the index of a batch. For ``pipeline`` and ``jobs``."""
