"""The vendor's list of errors, as far as somebody has written it into the cell file.

No list of these controllers is public, and an operator at night has no manual at hand. So the words
that the vendor gives for a number, and what to do, belong into the cell file as they become known.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Words = Annotated[str, Field(min_length=1, max_length=200)]


class ControllerError(BaseModel):
    """One entry of the list."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    text: Words
    """What the vendor's list says."""
    remedy: Words
    """What somebody at the cell does about it."""


class ErrorList(BaseModel):
    """The part of a robot's settings that holds the list."""

    controller_errors: dict[Annotated[int, Field(ge=1)], ControllerError] = {}
    """Entries of the vendor's list by the number that the controller reports."""

    def error_words(self, number: int) -> str:
        """The number with what is known of it; empty for 0, which is no error."""
        if number == 0:
            return ""
        known = self.controller_errors.get(number)
        return f"{number}" if known is None else f"{number}, {known.text}; {known.remedy}"
