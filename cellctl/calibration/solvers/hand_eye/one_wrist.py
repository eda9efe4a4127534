"""All poses of a calibration are reached with the arm folded in one way."""

from collections import Counter
from collections.abc import Mapping

from cellctl.errors.calibration import WristConfigurationsDiffer
from cellctl.geometry.pose import Array
from cellctl.geometry.wrist import wrist_configuration


def require_one_wrist(joints_rad: Mapping[str, Array]) -> None:
    """Raise ``WristConfigurationsDiffer`` unless all joints, by the name of their pose, agree."""
    # An arm's kinematic error differs from one way of folding it to the other by more than
    # the calibration is to be good for: several times the error of the result was measured.
    signs = {name: wrist_configuration(one) for name, one in joints_rad.items()}
    usual = Counter(signs.values()).most_common(1)
    other = [name for name, one in signs.items() if one != usual[0][0]]
    if other:
        raise WristConfigurationsDiffer(
            f"signs of A3 and A5 {usual[0][0]}, but otherwise in {', '.join(other)}"
        )
