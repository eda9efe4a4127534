"""One job that runs: its statements one after the other, each taking its time."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field

from fakes.robot_jobs import strings
from fakes.robot_jobs.lexer import JobError, Token
from fakes.robot_jobs.memory import Memory
from fakes.robot_jobs.motion import Motions
from fakes.robot_jobs.position import Position
from fakes.robot_jobs.program import Condition, Program, Statement
from fakes.robot_jobs.sockets import JobSocket, Route

_POLL_S = 0.002
_CATCH_UP_S = 0.01
"""Lateness beyond this is not made up for: after a long pause of the computer a job would otherwise
run through many statements at once, which no controller does."""
_WITHOUT_EFFECT = {"LABEL", "STOP_BG", "SETFRAME", "PAUSE"}
"""Words that change nothing that is modelled."""
_WAITING = {"DELAY", "WAIT", "MOVJ", "MOVL", "TCPCREATE", "TCPRECV", "TCPCLOSE"}


@dataclass(slots=True)
class Shared:
    """What the tasks of one controller share."""

    memory: Memory
    motions: Motions
    clock: Callable[[], float]
    timer: Callable[[], float]
    """The clock of TIMER, which a fault can let jump."""
    route: Route
    socket: Callable[[], JobSocket]
    start: Callable[[str], None]
    """START_BG."""
    frozen: Callable[[], bool]
    """Background tasks hang, as one of the faults."""
    statement_s: float


@dataclass(slots=True)
class Task:
    """``run`` ends with the job; raises ``JobError`` where the controller would show an alarm."""

    program: Program
    shared: Shared
    background: bool
    sockets: dict[str, JobSocket] = field(default_factory=dict)
    local: dict[int, Position] = field(default_factory=dict)
    executed: int = 0
    entered: set[str] = field(default_factory=set)
    """Labels that it has come to."""
    _place: int = 0
    _due_s: float = 0.0
    _timers_s: dict[str, float] = field(default_factory=dict)
    _skip: tuple[Token, float] | None = None

    async def run(self) -> None:
        """Execute until the end of the job; its sockets are closed then."""
        self._due_s = self.shared.clock()
        try:
            while self._place < len(self.program.statements):
                statement = self.program.statements[self._place]
                self._place += 1
                await self._take_time()
                try:
                    await self._execute(statement)
                except JobError as error:
                    where = f"{self.program.name}, line {statement.line}"
                    raise JobError(f"{where}: {error}") from None
        finally:
            for connection in self.sockets.values():
                await connection.close()

    async def _take_time(self) -> None:
        self.executed += 1
        now_s = self.shared.clock()
        # The computer's own lateness is made up for, within bounds, so that statements take the
        # time that was set and not that of this interpreter.
        self._due_s = max(self._due_s, now_s - _CATCH_UP_S) + self.shared.statement_s
        await asyncio.sleep(self._due_s - now_s if self._due_s - now_s > 1e-3 else 0)
        while self.background and self.shared.frozen():  # noqa: ASYNC110  a fault has no event
            await asyncio.sleep(_POLL_S)

    async def _execute(self, statement: Statement) -> None:
        word, found = statement.word, statement.tokens
        match word:
            case "IF":
                await self._branch(statement)
            case "JUMP":
                self._place = statement.jump
            case "LABEL":
                self.entered.add(found[0].text)
            case "GOTO":
                self._place = self.program.labels[found[0].text]
            case _ if word in strings.WORDS:
                strings.execute(word, found, self.shared.memory)
            case _ if word in _WAITING:
                await self._wait(word, found)
                # What was waited for is not caught up with afterwards.
                self._due_s = self.shared.clock()
            case _ if word not in _WITHOUT_EFFECT:
                self._compute(word, found)

    def _compute(self, word: str, found: tuple[Token, ...]) -> None:
        memory = self.shared.memory
        match word:
            case "=":
                self._assign(found)
            case "SET":
                self._set(found)
            case "GETP":
                memory.position(found[0], self.local).get(self.shared.motions.here())
            case "SETP":
                memory.position(found[0], self.local).set_frame(int(self._value(found[3])))
            case "IN":
                memory.set_number(found[0], self._value(found[2]), self.local)
            case "OUT":
                memory.set_output(found[0], self._value(found[1]))
            case "SKIP":
                self._skip = found[1], self._value(found[3])
            case _:
                self._control(word, found)

    def _control(self, word: str, found: tuple[Token, ...]) -> None:
        match word:
            case "TIMER":
                self._timer(found)
            case "START_BG":
                self.shared.start(found[0].text)
            case "TCPSEND":
                self._socket(found).send(self.shared.memory.string(found[1]))
            case _:
                raise JobError(f"user alarm {int(self._value(found[-1]))}")

    async def _wait(self, word: str, found: tuple[Token, ...]) -> None:
        match word:
            case "DELAY":
                await asyncio.sleep(self._value(found[-1]))
            case "WAIT":
                limit_s = self._value(found[-1]) / 1000
                await self._until(lambda: self._value(found[0]) == self._value(found[2]), limit_s)
            case "MOVJ" | "MOVL":
                await self._move(word, found)
            case "TCPCREATE":
                address = self.shared.route(found[3].text, int(self._value(found[6])))
                await self._socket(found).create(*address)
            case "TCPRECV":
                await self._receive(found)
            case _:
                await self._socket(found).close()

    def _value(self, token: Token) -> float:
        return self.shared.memory.number(token, self.local)

    def _holds(self, condition: Condition) -> bool:
        compare = {
            "==": float.__eq__, "!=": float.__ne__, ">": float.__gt__,
            ">=": float.__ge__, "<": float.__lt__, "<=": float.__le__,
        }  # fmt: skip
        results = (
            bool(compare[relation](float(self._value(left)), float(self._value(right))))
            for left, relation, right in condition.parts
        )
        return all(results) if condition.every else any(results)

    async def _branch(self, statement: Statement) -> None:
        assert statement.condition is not None  # by the grammar
        holds = self._holds(statement.condition)
        if statement.then is not None:
            if holds:
                await self._execute(statement.then)
        elif not holds:
            self._place = statement.jump

    def _assign(self, found: tuple[Token, ...]) -> None:
        memory, target, values = self.shared.memory, found[0], found[2:]
        if target.kind == "S":
            memory.set_string(target, "".join(memory.string(one) for one in values[::2]))
            return
        if values[0].text in {"ABS", "SQRT"}:
            number = self._value(values[1])
            result = abs(number) if values[0].text == "ABS" else number**0.5
        else:
            result = self._value(values[0])
            for sign, token in zip(values[1::2], values[2::2], strict=True):
                result = _combined(result, sign.text, self._value(token))
        memory.set_number(target, result, self.local)

    def _set(self, found: tuple[Token, ...]) -> None:
        memory, (target, source) = self.shared.memory, found
        if target.kind == "S":
            memory.set_string(target, memory.string(source))
        elif target.kind == "P":
            memory.position(target, self.local).copy(memory.position(source, self.local))
        else:
            memory.set_number(target, self._value(source), self.local)

    def _timer(self, found: tuple[Token, ...]) -> None:
        """Milliseconds since START; an assumption that the installation sheet has verified."""
        now_s, index = self.shared.timer(), found[3].text
        if found[0].text == "START":
            self._timers_s[index] = now_s
        else:
            started_s = self._timers_s.get(index, now_s)
            self.shared.memory.set_number(found[4], 1000 * (now_s - started_s), self.local)

    async def _move(self, word: str, found: tuple[Token, ...]) -> None:
        """A motion to its end, or to its label as soon as the condition of SKIP holds."""
        motions, speed = self.shared.motions, self._value(found[3])
        target = self.shared.memory.position(found[0], self.local)
        label = found[-1].text if found[-1].kind == "T" else None
        if label is not None and self._skipping():
            self._place = self.program.labels[label]
            return
        motions.begin(word, target, speed, float(found[6].text))
        skipped = False
        while motions.moving() or motions.cut_short:
            if label is not None and self._skipping() and not skipped:
                motions.stop()
                skipped = True
            if not motions.moving() and skipped:
                break
            await asyncio.sleep(_POLL_S)
        if skipped and label is not None:
            self._place = self.program.labels[label]

    def _skipping(self) -> bool:
        return self._skip is not None and self._value(self._skip[0]) == self._skip[1]

    async def _until(self, holds: Callable[[], bool], limit_s: float) -> None:
        end_s = self.shared.clock() + limit_s
        while not holds() and self.shared.clock() < end_s:  # noqa: ASYNC110  signals have no event
            await asyncio.sleep(_POLL_S)

    def _socket(self, found: tuple[Token, ...]) -> JobSocket:
        if found[0].text not in self.sockets:
            self.sockets[found[0].text] = self.shared.socket()
        return self.sockets[found[0].text]

    async def _receive(self, found: tuple[Token, ...]) -> None:
        """The result is the number of characters, 0 after the time-out, -1 without a connection."""
        memory = self.shared.memory
        most, timeout_ms = int(self._value(found[2])), self._value(found[5])
        data = await self._socket(found).receive(most, timeout_ms)
        memory.set_string(found[1], (data or b"").decode("ascii", "replace"))
        memory.set_number(found[6], -1.0 if data is None else float(len(data)), self.local)


def _combined(one: float, sign: str, other: float) -> float:
    match sign:
        case "+":
            return one + other
        case "-":
            return one - other
        case "*":
            return one * other
        case "/":
            return one / other
        case _:
            return float(int(one) & int(other))
