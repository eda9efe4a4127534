"""Client of the local API: brings the commands of the operator to the daemon."""

import os
import socket
import struct
import time
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from cellctl.api.local_socket.messages import (
    ANSWER_LIMIT,
    Answer,
    CommandRequest,
    Failed,
    GivenCommand,
    Refused,
    Request,
    RobotAnswer,
    RobotRequest,
    StatusAnswer,
    StatusRequest,
    parse_answer,
    to_line,
)
from cellctl.api.local_socket.report import StatusReport
from cellctl.cli.nearest_cell import nearest_socket, socket_places
from cellctl.clock import Monotonic, now_s
from cellctl.errors.local import (
    CommandMissedItsGoal,
    CommandRefused,
    DaemonNotReached,
    DaemonSlow,
    MessageMalformed,
)

ANSWER_S = 10.0
"""At least ``MOST_AGE_S`` of the daemon: whoever is told that it does not answer must not find an
arm moving later."""
SETTLE_S = 60.0
_POLL_S = 0.2
_PATIENT_POLL_S = 1.0
"""While a whole run is waited for: the daemon has other things to do."""


class DaemonClient:
    """Asks the daemon, one connection per question."""

    def __init__(self, path: Path | None, *, clock: Monotonic = now_s) -> None:
        self._path = path or nearest_socket()
        self._named = path is not None
        self._now_s = clock

    def status(self) -> StatusReport:
        """The cell at this moment; raises ``DaemonNotReached``, ``DaemonSlow`` or
        ``MessageMalformed``."""
        answer = self._ask(StatusRequest())
        if not isinstance(answer, StatusAnswer):
            raise MessageMalformed(f"no status: {answer}")
        return answer.report

    def robot(self, name: str, seconds: float) -> RobotAnswer:
        """What the daemon hears of a robot for so long; raises as ``status``."""
        answer = self._ask(RobotRequest(name=name, seconds=seconds), ANSWER_S + seconds)
        if not isinstance(answer, RobotAnswer):
            raise MessageMalformed(f"no robot: {answer}")
        return answer

    def command(self, request: CommandRequest) -> None:
        """Have a command obeyed; raises ``CommandRefused`` with the reason."""
        answer = self._ask(GivenCommand(given_s=now_s(), command=request))
        if isinstance(answer, Refused):
            raise CommandRefused("; ".join(_refusal(answer)))

    def settled(
        self,
        states: Collection[str] = (),
        timeout_s: float | None = SETTLE_S,
        *,
        seen: Callable[[StatusReport], None] = lambda _report: None,
    ) -> StatusReport:
        """Wait until the unit is in one of ``states``; without any, until it stays where it is.

        ``seen`` gets every report on the way. Raises ``CommandMissedItsGoal`` after ``timeout_s``;
        None waits without an end.
        """
        end_s = None if timeout_s is None else self._now_s() + timeout_s
        while True:
            report = self.status()
            seen(report)
            # An acting state is on its way to another one; only in a wait state are both the same.
            there = report.state in states if states else report.state == report.state_requested
            if there:
                return report
            if end_s is not None and self._now_s() > end_s:
                raise CommandMissedItsGoal(f"still {report.state} after {timeout_s:g} s")
            time.sleep(_PATIENT_POLL_S if end_s is None else _POLL_S)

    def _ask(self, request: Request, answer_s: float = ANSWER_S) -> Answer:
        begun_s, process = now_s(), ""
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
                connection.settimeout(answer_s)
                connection.connect(str(self._path))
                process = _process(connection)
                connection.sendall(to_line(request))
                with connection.makefile("rb") as lines:
                    line = lines.readline(ANSWER_LIMIT)
        # Somebody holds the socket: the connection was taken, or waits behind others.
        except (TimeoutError, BlockingIOError) as error:
            waited = f"{self._path}: no answer within {now_s() - begun_s:.1f} s"
            raise DaemonSlow("; ".join(filter(None, (waited, process, _load())))) from error
        except OSError as error:
            searched = "" if self._named else f"; searched {socket_places()}"
            facts = f"{self._path}: {error.strerror or error}{searched}"
            raise DaemonNotReached(facts) from error
        # A line without its end was cut off: the daemon ended, or the answer is longer than an
        # answer may be.
        if not line.endswith(b"\n"):
            raise DaemonNotReached(f"{self._path}: it hung up")
        answer = parse_answer(line)
        if isinstance(answer, Failed):
            raise MessageMalformed(answer.text)
        return answer


def _process(connection: socket.socket) -> str:
    """The process that listens, and whether it was suspended; empty where it cannot be told."""
    format_ = "3i"
    found = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize(format_))
    number = struct.unpack(format_, found)[0]
    try:
        state = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return ""
    return f"process {number} is {'suspended' if state in 'Tt' else 'alive'}"


def _load() -> str:
    processors = len(os.sched_getaffinity(0))
    return (
        f"in the last minute {os.getloadavg()[0]:.1f} programs on average wanted the "
        f"{processors} processors of this PC"
    )


def _refusal(answer: Refused) -> Iterator[str]:
    yield f"0x{answer.code:X} {answer.text} (state {answer.state.capitalize()})"
    if answer.remedy:
        yield answer.remedy
    if answer.known:
        yield f"this cell has {', '.join(answer.known)}"
    if answer.permitted:
        yield f"permitted now: {', '.join(answer.permitted)}"
