"""A sidecar of two megabytes."""

CONTENT = b"version: 1\n" + b"# padding\n" * 200_000
