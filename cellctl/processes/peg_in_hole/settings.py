"""Settings of the process for all of its recipes: ``[processes.peg-in-hole]``."""

from typing import Annotated

from pydantic import Field

from cellctl.config.base import LessSafe, Section

STIFFNESS_N_MM, DEAD_TIME_MS = (1.0, 10_000.0), (1.0, 200.0)
"""What a cell can have."""


class PegSettings(Section):
    """What was measured of arm, sensor and loop in contact."""

    stiffness_n_mm: Annotated[
        float, Field(ge=STIFFNESS_N_MM[0], le=STIFFNESS_N_MM[1]), LessSafe.WITH_LESS
    ]
    """Upper bound for arm and contact in series at the tip, along the axis of the hole."""
    dead_time_ms: Annotated[
        float, Field(ge=DEAD_TIME_MS[0], le=DEAD_TIME_MS[1]), LessSafe.WITH_LESS
    ]
    """Upper bound from a force at the tip to a motion of the tip in answer. Both bounds count until
    procedure 301 has measured better figures."""
    repeatability_mm: Annotated[float, Field(gt=0, le=1)]
    """Of the arm along a search, standard deviation."""
    height_sigma_mm: Annotated[float, Field(gt=0, le=1)]
    """Of one reading of the height in contact, standard deviation."""
    force_sigma_n: Annotated[float, Field(gt=0, le=10)]
    """Of the mean of ten samples of one component of the force, standard deviation."""
    panel_shift_mm: Annotated[float, Field(gt=0, le=5)] = 0.3
    """How far along its normal a face may be met from its reference (procedure 302)."""
    panel_turn_deg: Annotated[float, Field(gt=0, le=3)] = 0.5
    """How far it may be turned; the touches see 0.1° at a repeatability of 0.02 mm on 15 mm."""
    validity_days: Annotated[int, Field(ge=1, le=3650)] = 365
    """Of what procedures 301 and 302 measure."""
    lost_tick_ms: Annotated[float, Field(ge=10, le=1000), LessSafe.WITH_MORE] | None = None
    """A tick of the stream that comes later than this ends the contact at standstill; left out: 50
    ms, or ten periods of the stream where they are less."""
    old_force_ms: Annotated[float, Field(ge=1, le=1000), LessSafe.WITH_MORE] = 5.0
    """A force older than this lets the arm go no further."""
    lost_force_ms: Annotated[float, Field(ge=5, le=1000), LessSafe.WITH_MORE] = 20.0
    """A force older than this ends the contact."""
