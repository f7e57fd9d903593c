"""One module per drive test, each with ``experiment(stage)``; see :class:`~stepbot.driving.results.Result`."""
