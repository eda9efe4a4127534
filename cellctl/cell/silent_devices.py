"""Asks devices that report nothing by themselves, each for something that only it can answer."""

import asyncio
from collections.abc import Coroutine, Mapping
from typing import Any

from cellctl.cell.patience.calls import answer_within
from cellctl.errors import CellError


async def unanswered(
    questions: Mapping[str, Coroutine[Any, Any, object]], ask_s: float
) -> dict[str, CellError]:
    """The faults of the devices that have not answered within ``ask_s``, by the names given.

    Raises what is no fault of a device.
    """
    # One device that hangs must not hide the answers of the others, so every question has its own
    # time-out and no fault ends the round.
    asked = (answer_within(question, name, ask_s) for name, question in questions.items())
    answers = await asyncio.gather(*asked, return_exceptions=True)
    faults: dict[str, CellError] = {}
    for name, answer in zip(questions, answers, strict=True):
        if isinstance(answer, CellError):
            faults[name] = answer
        elif isinstance(answer, BaseException):
            # A defect or a cancellation: it must not look like a device that is silent.
            raise answer
    return faults
