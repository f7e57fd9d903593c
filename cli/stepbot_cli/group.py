"""Base class of command groups; imports only click."""

import click


class Group(click.Group):
    """A command group that suggests similar commands for unknown ones."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command named by the first argument.

        Raises:
            click.UsageError: There is no such command.
        """
        name = args[0]
        if not name.startswith("-") and self.get_command(ctx, name) is None and not ctx.resilient_parsing:
            from stepbot.diagnostics import did_you_mean

            commands = self.list_commands(ctx)
            near = "".join(did_you_mean(name, commands)) or f"choose from {', '.join(commands)}"
            raise click.UsageError(f"unknown command '{name}'; {near}", ctx)
        return super().resolve_command(ctx, args)
