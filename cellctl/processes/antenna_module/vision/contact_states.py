"""The verdict on every contact."""

import numpy as np

from cellctl.processes.antenna_module.vision.matching import rotation
from cellctl.processes.antenna_module.vision.measurement import ContactState, MeasuredContact
from cellctl.processes.antenna_module.vision.pattern import Feature, Pattern, PatternFit
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

_ABSENT = 0.35
"""A place with less contrast than this share of the others' holds nothing."""


def contact_states(
    found: PatternFit, pattern: Pattern, plane: MeasuringPlane
) -> tuple[MeasuredContact, ...]:
    """Missing, bent, hidden or good, for every contact of the drawing.

    Bent is a clean contact that the fit left out: farther off its place than six standard
    deviations of true position and image together.
    """
    fit = found.fit
    nominal = pattern.positions_m @ rotation(fit.yaw_rad).T + fit.shift_m
    good = [item.contrast for item, used in zip(found.features, fit.used, strict=True) if used]
    typical = float(np.median(good))
    contacts: list[MeasuredContact] = []
    for index, feature in enumerate(found.features):
        state = _state(feature, used=bool(fit.used[index]), typical=typical)
        circle = None if state == "missing" else feature.circle
        place = nominal[index] if circle is None else circle.centre_m
        by_m = plane.px_by_m(place)
        contacts.append(
            MeasuredContact(
                name=feature.name,
                state=state,
                px=plane.to_px(place[None])[0],
                covariance_px2=None if circle is None else by_m @ circle.covariance_m2 @ by_m.T,
                residual_m=None if circle is None else fit.residuals_m[index],
            )
        )
    return tuple(contacts)


def _state(feature: Feature, *, used: bool, typical: float) -> ContactState:
    if used:
        return "ok"
    if feature.clean:
        return "bent"
    return "missing" if feature.contrast < _ABSENT * typical else "hidden"
