"""How long stepbot takes, beside others on the same files; ``python -m benchmarks --help``, benchmarks/NOTES.md."""
