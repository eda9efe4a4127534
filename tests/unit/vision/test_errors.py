from cellctl.errors import catalogue
from cellctl.errors.vision import VisionError


def test_every_fault_of_vision_is_distinct_and_complete() -> None:
    faults = catalogue(VisionError)
    assert len(faults) >= 18
    assert all(400 <= fault.number < 500 for fault in faults)
    for attribute in ("number", "text", "cause", "remedy"):
        values = [getattr(fault, attribute) for fault in faults]
        assert all(values)
        assert len(set(values)) == len(values)
