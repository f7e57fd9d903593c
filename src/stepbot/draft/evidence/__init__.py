"""Evidence that parts are welded or joined, one rule per file."""
