"""Parts of addresses that several routes have, and what bounds them."""

from typing import Annotated

from fastapi import Path

MOST = 2**53 - 1
"""What a number of JSON holds exactly, and SQLite at all."""
RunNumber = Annotated[int, Path(description="Number of the run.")]
CalibrationId = Annotated[
    str,
    Path(alias="id", max_length=80, description="Identity of the calibration, as runs name it."),
]
