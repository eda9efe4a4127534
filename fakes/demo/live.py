"""What the demonstration shows while it runs: state and step, and what its process adds."""

from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from fakes.demo.demo import Demo

_TELLING = ("state", "step_number", "iteration", "alarms")
"""A change of one of these is worth a line."""


class LiveView:
    """A line for each event; below them, on a terminal, what is true just now."""

    def __init__(self, console: Console, demo: Demo) -> None:
        self._console = console
        self._demo = demo
        self._telling = (*_TELLING, *demo.telling)
        self._live = Live(console=console, refresh_per_second=8, transient=True)
        self._last: dict[str, Any] = {}
        self._begun_s: float | None = None

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
        if self._begun_s is None:
            self._begun_s = message["time"]
        # The register shows no step between two of them; a line for that would only be noise.
        pause = message["state"] == "EXECUTE" and not message["step_number"]
        if any(self._last.get(key) != message.get(key) for key in self._telling) and not pause:
            time_s = message["time"] - self._begun_s
            self._console.print(f"{time_s:6.1f} s  {self._news(message)}", markup=False)
        self._last = message
        if self._console.is_terminal:
            self._live.update(self._panel(message))

    def _news(self, now: dict[str, Any]) -> str:
        """What has changed, in words; figures only when they are new."""
        parts = [self._demo.news(self._last, now) or self._where(now)]
        if now.get("alarms"):
            parts.append(_alarms(now))
        return ", ".join(parts)

    def _where(self, now: dict[str, Any]) -> str:
        return self._step(now) if now["state"] == "EXECUTE" and now["step_number"] else _state(now)

    def _step(self, now: dict[str, Any]) -> str:
        number = now.get("step_number", 0)
        return self._demo.steps.get(number, str(number) if number else "")

    def _panel(self, now: dict[str, Any]) -> Table:
        table = Table(show_header=False, box=None, padding=(0, 2))
        rows = {
            "state": _state(now),
            "step": self._step(now) or "-",
            **self._demo.rows(now),
            "alarms": _alarms(now) if now.get("alarms") else "none",
        }
        for name, value in rows.items():
            table.add_row(Text(name, style="dim"), Text(value))
        return table


def _state(now: dict[str, Any]) -> str:
    return str(now["state"]).capitalize()


def _alarms(now: dict[str, Any]) -> str:
    return "alarm " + ", ".join(f"F{number:03d}" for number in now["alarms"])
