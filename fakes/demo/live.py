"""What the demonstration shows while it runs: state, step, iteration, errors, force."""

from collections import deque
from types import TracebackType
from typing import Any, Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

HISTORY = 12


class LiveView:
    """A live panel on a terminal, plain lines elsewhere."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._live = Live(console=console, refresh_per_second=8, transient=False)
        self._events: deque[str] = deque(maxlen=HISTORY)
        self._last: dict[str, Any] = {}

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._console.is_terminal:
            self._live.stop()

    def show(self, message: dict[str, Any]) -> None:
        """Take in one message of the line PLC."""
        if message.get("event") != "report":
            return
        line = _news(self._last, message)
        self._last = message
        if line:
            self._events.append(line)
            if not self._console.is_terminal:
                self._console.print(line)
        if self._console.is_terminal:
            self._live.update(Group(_table(message), *map(Text, self._events)))


def _news(before: dict[str, Any], now: dict[str, Any]) -> str:
    """A line for the history when something worth a line has changed."""
    if any(before.get(key) != now.get(key) for key in ("state", "step", "iteration", "alarms")):
        parts = [f"{now['state']:11}", f"{now['step'] or '-'}"]
        if now.get("iteration"):
            parts.append(f"{now['iteration']:2d}  {_errors(now)}")
        if now.get("alarms"):
            parts.append("alarms " + ", ".join(f"F{number}" for number in now["alarms"]))
        return "  ".join(parts)
    return ""


def _table(now: dict[str, Any]) -> Table:
    table = Table(show_header=False, box=None, padding=(0, 2))
    force, limit = now.get("force_z_n"), now.get("force_limit_n")
    rows = {
        "state": now["state"],
        "step": now["step"] or "-",
        "iteration": str(now.get("iteration") or "-"),
        "error": _errors(now),
        "force z": "-" if force is None else f"{force:7.2f} N" + _of(limit),
        "alarms": ", ".join(f"F{number}" for number in now.get("alarms", ())) or "none",
    }
    for name, value in rows.items():
        table.add_row(Text(name, style="dim"), Text(value))
    return table


def _of(limit: float | None) -> str:
    return "" if limit is None else f"  (limit {limit:.0f} N)"


def _errors(now: dict[str, Any]) -> str:
    def written(values: list[float | None], digits: int) -> str:
        return " ".join("-" if value is None else f"{value:+.{digits}f}" for value in values)

    millimetres, degrees = now.get("error_mm") or [], now.get("error_deg") or []
    if not any(value is not None for value in (*millimetres, *degrees)):
        return ""
    return f"{written(millimetres, 3)} mm  {written(degrees, 4)} deg"
