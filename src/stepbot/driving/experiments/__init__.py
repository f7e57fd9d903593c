"""The drive tests, each a function of a stage; see :class:`~stepbot.driving.results.Result`."""
