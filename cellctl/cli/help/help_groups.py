"""Groups the commands of `cellctl --help` by their purpose."""

from collections.abc import Iterator
from typing import Any

from typer.core import TyperGroup

OFFLINE = "From files, without a cell"
"""Panel of the commands that need files alone; those of processes belong there, too."""
OPERATE = "Operate the running cell"
"""Panel of the commands to the daemon."""
_OTHERS = "Commands"


class GroupedCommands(TyperGroup):
    """Lists the commands under the panel that each was registered with."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write one section per panel, in the order of registration."""
        # Without rich markup Typer does not show the panels that commands are registered with, so
        # they are printed here.
        sections: dict[str, list[tuple[str, str]]] = {}
        for name, panel, summary in self.rows(ctx):
            sections.setdefault(panel, []).append((name, summary))
        for title, rows in sections.items():
            with formatter.section(title):
                formatter.write_dl(rows)

    def rows(self, ctx: Any) -> Iterator[tuple[str, str, str]]:
        """Name, panel and summary of each command."""
        for name in self.list_commands(ctx):
            command = self.get_command(ctx, name)
            if command is None or command.hidden:
                continue
            panel = getattr(command, "rich_help_panel", None)
            title = panel if isinstance(panel, str) else _OTHERS
            yield name, title, command.get_short_help_str(80)
