"""The settings of a large-field head behind a target server. Seconds."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Seconds = Annotated[float, Field(gt=0.0, le=600.0)]


class TargetServerConfig(BaseModel):
    """Where the server listens, and how long it may take."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    host: str
    port: Annotated[int, Field(ge=1, le=65535)]
    connect_timeout_s: Seconds = 5.0
    reply_timeout_s: Seconds = 10.0
    """From a request to its reply, for one frame."""
    frame_timeout_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.5
    """More time for each frame that a measurement averages."""
