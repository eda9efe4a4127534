"""The settings of a camera or stereo head behind a frame server. Seconds."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Seconds = Annotated[float, Field(gt=0.0, le=600.0)]


class FrameServerConfig(BaseModel):
    """Where the server listens, and how long it may take."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    host: str
    port: Annotated[int, Field(ge=1, le=65535)]
    connect_timeout_s: Seconds = 5.0
    reply_timeout_s: Seconds = 15.0
    """From a request to the last byte of its reply: exposure, read-out and transfer."""
