"""Requests to the guard and the answers that belong to them."""

import asyncio
import itertools
from collections.abc import Callable
from typing import Any

from cellctl.errors.force import GuardDied, GuardRefused
from cellctl.guard.messages import Message


class Requests:
    """Numbers what is asked and wakes whoever asked."""

    def __init__(self, reply_timeout_s: float) -> None:
        self._reply_timeout_s = reply_timeout_s
        self._ids = itertools.count(1)
        self._answers: dict[int, asyncio.Future[Any]] = {}

    async def ask(self, send: Callable[[Message], None], request: Message, wait_s: float) -> Any:
        """Send and wait, ``wait_s`` longer than usual; ``GuardRefused`` or ``GuardDied``."""
        number = next(self._ids)
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._answers[number] = answer
        timeout_s = self._reply_timeout_s + wait_s
        try:
            send({"id": number, **request})
            async with asyncio.timeout(timeout_s):
                return await answer
        except TimeoutError:
            words = f"no answer to {request['do']} within {timeout_s:g} s"
            raise GuardDied(words) from None
        finally:
            del self._answers[number]

    def take(self, message: Message) -> None:
        """An answer; one that nobody waits for any more is dropped."""
        answer = self._answers.get(message["id"])
        if answer is None or answer.done():
            return
        if "refused" in message:
            answer.set_exception(GuardRefused(message["refused"]))
        else:
            answer.set_result(message["result"])

    def fail(self, fault: GuardDied) -> None:
        """Whoever waits hears that no answer will come."""
        for answer in self._answers.values():
            if not answer.done():
                answer.set_exception(fault)
