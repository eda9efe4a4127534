import math
from dataclasses import replace

import pytest

from cellctl.errors.force import SensorSetupWrong
from cellctl.errors.internal import Unexpected
from cellctl.guard.limits import CusumTouch, GuardLimits
from cellctl.guard.messages import (
    encode,
    fault_from_json,
    fault_to_json,
    limits_from_json,
    limits_to_json,
    trip_from_json,
    trip_to_json,
)
from cellctl.guard.report import GuardTrip, TripReason


def over_the_wire(message: dict[str, object]) -> dict[str, object]:
    import json

    return dict(json.loads(encode(message)))


@pytest.mark.parametrize("touch", [None, CusumTouch(3.0, 90.0, 1, -1.0)])
def test_limits(touch: CusumTouch | None) -> None:
    limits = GuardLimits(raw=(math.inf, 1.0, 2.0, 3.0, 4.0, 5.0), touch=touch)
    assert limits_from_json(over_the_wire(limits_to_json(limits))) == limits
    limits = replace(limits, braking=(9.0,) * 6)
    assert limits_from_json(over_the_wire(limits_to_json(limits))) == limits


@pytest.mark.parametrize("reason", TripReason)
def test_trips(reason: TripReason) -> None:
    trip = GuardTrip(reason, 12.5, "Fz 51.0 N", 2, 51.0)
    assert trip_from_json(over_the_wire(trip_to_json(trip))) == trip
    assert trip.fault().number
    assert str(trip) == f"{reason.value}: Fz 51.0 N"


def test_faults() -> None:
    back = fault_from_json(over_the_wire(fault_to_json(SensorSetupWrong("rate is 5"))))
    assert isinstance(back, SensorSetupWrong)
    assert back.detail == "rate is 5"
    assert isinstance(fault_from_json({"number": 12345, "detail": "x"}), Unexpected)


@pytest.mark.parametrize(
    "change",
    [
        {"raw": (0.0,) * 6},
        {"braking": (0.0,) * 6},
        {"stale_s": -1.0},
        {"frozen_samples": 1},
        {"raw": (math.nan,) * 6},
    ],
    ids=str,
)
def test_limits_that_could_not_trip_are_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="positive"):
        GuardLimits(**change)  # type: ignore[arg-type]
