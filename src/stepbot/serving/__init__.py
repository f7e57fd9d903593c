"""A robot's page with a server behind it, on this machine alone. For ``api`` and above."""
