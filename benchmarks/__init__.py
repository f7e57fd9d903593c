"""How long stepbot takes, beside others on the same files; ``python -m benchmarks --help``, docs/performance.md."""
