"""What all models of answers share."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, PlainSerializer, WithJsonSchema


def as_text(time: datetime) -> str:
    """A time as all answers have it: ISO 8601 with its zone, to the millisecond."""
    return time.isoformat(timespec="milliseconds")


Time = Annotated[
    datetime,
    PlainSerializer(as_text, return_type=str),
    WithJsonSchema({"type": "string", "format": "date-time"}),
]


class Form(BaseModel):
    """An answer, or a part of one. The texts under its fields go into the document of the API."""

    model_config = ConfigDict(frozen=True, use_attribute_docstrings=True)
