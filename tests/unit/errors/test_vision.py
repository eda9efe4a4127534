from cellctl.errors import catalogue
from cellctl.errors.vision import VisionError


def test_every_fault_of_vision_is_distinct_and_complete() -> None:
    # Processes that see have faults of their own, in blocks of their own.
    own = "cellctl.errors."
    faults = [fault for fault in catalogue(VisionError) if fault.__module__.startswith(own)]
    assert len(faults) >= 15
    assert all(400 <= fault.number < 500 for fault in faults)
    for attribute in ("number", "text", "cause", "remedy"):
        values = [getattr(fault, attribute) for fault in faults]
        assert all(values)
        assert len(set(values)) == len(values)
