"""From evidence to links and joints."""
