"""What looks, calibrations and correction must have in common before they are composed."""

from collections.abc import Iterable

from cellctl.errors.calibration import WristConfigurationsDiffer
from cellctl.geometry.wrist import wrist_configuration
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.chain.looks import Look, Looks
from cellctl.processes.antenna_module.faults.plugging import (
    CalibrationsDoNotBelongTogether,
    LooksIncomplete,
    StaleLook,
)

MAX_AGE_S = 60.0
"""Greatest time between a look and its plan. In it a warming cell moves by well below a
micrometre."""


def require_fresh(looks: Looks, now_s: float, max_age_s: float = MAX_AGE_S) -> None:
    """Raise ``StaleLook`` for a look that is too old or was taken after ``now_s``."""
    for look in looks.all():
        age_s = now_s - look.time_s
        # Written so that a time that is not a number fails, too.
        if not 0.0 <= age_s <= max_age_s:
            raise StaleLook(f"{type(look).__name__}: {age_s:.1f} s old, allowed {max_age_s:g} s")


def require_one_set(looks: Looks, cell: PlugCell) -> None:
    """Raise ``CalibrationsDoNotBelongTogether`` when a picture was measured with other intrinsics
    than its camera's hand-eye calibration, ``LooksIncomplete`` without a look at the socket.
    """
    if not looks.sockets:
        raise LooksIncomplete("no look at the socket")
    for name, mounted, used in (
        ("camera I", cell.cam1, looks.camera_1_ids),
        ("camera II", cell.cam2, looks.camera_2_ids),
    ):
        other = used - {mounted.camera_id}
        if other:
            raise CalibrationsDoNotBelongTogether(
                f"{name}: measured with intrinsics {', '.join(sorted(other))}, "
                f"hand-eye made with {mounted.camera_id}"
            )
    sockets = {look.connector for look in looks.sockets}
    if len(sockets) > 1:
        raise CalibrationsDoNotBelongTogether(f"looks at sockets {', '.join(sorted(sockets))}")


def require_one_wrist(looks: Iterable[Look]) -> tuple[int, ...]:
    """The configuration of all looks; raises ``WristConfigurationsDiffer``."""
    found = {wrist_configuration(look.joints_rad) for look in looks}
    if len(found) != 1:
        raise WristConfigurationsDiffer(f"signs of A3 and A5: {_signs(found)}")
    (one,) = found
    if 0 in one:
        raise WristConfigurationsDiffer("A3 or A5 is within 1° of straight, where the arm may fold")
    return one


def require_wrist(found: tuple[int, ...], taught: tuple[int, ...]) -> None:
    """Raise ``WristConfigurationsDiffer`` when the correction was taught in another one."""
    if found != taught:
        raise WristConfigurationsDiffer(
            f"signs of A3 and A5: {_signs([found])}, correction taught with {_signs([taught])}"
        )


def _signs(configurations: Iterable[tuple[int, ...]]) -> str:
    return " and ".join(str(tuple(one)) for one in sorted(configurations))
