"""The table, row by row."""

import sys
from dataclasses import dataclass, field

from rich.table import Table


@dataclass
class Report:
    """Rows of the table, and how many demands were missed."""

    table: Table = field(
        default_factory=lambda: Table(
            "no.", "images", "n", "demanded", "default", "paper", "verdict", title="Vision"
        )
    )
    missed: int = 0

    def row(
        self,
        number: str,
        what: str,
        count: int,
        *,
        demanded: str,
        default: str,
        paper: str = "",
        good: bool,
    ) -> None:
        """Add a row, and show it at once: the whole table takes minutes."""
        self.missed += not good
        verdict = "reached" if good else "MISSED"
        cells = (number, what, str(count), demanded, default, paper, verdict)
        self.table.add_row(*cells)
        sys.stderr.write(" | ".join(cells) + "\n")
