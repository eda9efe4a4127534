"""What the demonstration shows while it runs: state, step, iteration, errors, force."""

from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

_TELLING = ("state", "step", "iteration", "alarms")
"""A change of one of these is worth a line."""
_AXES = ("x", "y", "z")


class LiveView:
    """A line for each event; below them, on a terminal, what is true just now."""

    def __init__(self, console: Console) -> None:
        self._console = console
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
        pause = message["state"] == "EXECUTE" and not message["step"]
        if any(self._last.get(key) != message.get(key) for key in _TELLING) and not pause:
            time_s = message["time"] - self._begun_s
            self._console.print(f"{time_s:6.1f} s  {_news(self._last, message)}", markup=False)
        self._last = message
        if self._console.is_terminal:
            self._live.update(_panel(message))


def _news(before: dict[str, Any], now: dict[str, Any]) -> str:
    """What has changed, in words; figures only when they are new."""
    parts = [_where(now)]
    iteration = now.get("iteration")
    if iteration and iteration != before.get("iteration"):
        parts = [f"#{iteration}  {_errors(now)}"]
    if now.get("alarms"):
        parts.append(_alarms(now))
    return ", ".join(parts)


def _where(now: dict[str, Any]) -> str:
    return str(now["step"]) if now["state"] == "EXECUTE" and now["step"] else _state(now)


def _state(now: dict[str, Any]) -> str:
    return str(now["state"]).capitalize()


def _alarms(now: dict[str, Any]) -> str:
    return "alarm " + ", ".join(f"F{number:03d}" for number in now["alarms"])


def _panel(now: dict[str, Any]) -> Table:
    table = Table(show_header=False, box=None, padding=(0, 2))
    rows = {
        "state": _state(now),
        "step": now["step"] or "-",
        "iteration": str(now.get("iteration") or "-"),
        "error": _errors(now).replace("  r", "\nr") or "-",
        "force z": _force(now),
        "alarms": _alarms(now) if now.get("alarms") else "none",
    }
    for name, value in rows.items():
        table.add_row(Text(name, style="dim"), Text(value))
    return table


def _force(now: dict[str, Any]) -> str:
    force, limit = now.get("force_z_n"), now.get("force_limit_n")
    peak = (now.get("force_peaks") or [None] * 3)[2]
    parts = ["-" if force is None else f"{force + 0.0:7.2f} N"]
    if peak is not None:
        parts.append(f"peak {peak:.1f} N")
    if limit is not None:
        parts.append(f"limit {limit:.0f} N")
    return "   ".join(parts)


def _errors(now: dict[str, Any]) -> str:
    """Lengths to a micrometre, angles to a ten-thousandth of a degree; empty without any."""
    millimetres, degrees = now.get("error_mm") or [], now.get("error_deg") or []
    if not any(value is not None for value in (*millimetres, *degrees)):
        return ""
    return f"{_written('', millimetres, 3)} mm  {_written('r', degrees, 4)} °"


def _written(prefix: str, values: Sequence[float | None], digits: int) -> str:
    return " ".join(
        f"{prefix}{axis} " + ("-" if value is None else f"{value:+.{digits}f}")
        for axis, value in zip(_AXES, values, strict=True)
    )
