"""Files of still poses in other units, or in another order, than their columns say.

A file of forces in kN is fitted as well as one in N; only the mass is wrong by a thousand. The
hints here are added to the refusal of such a file, so that the operator finds the mistake.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.errors import CellError
from cellctl.force.gravity.payload_result import PayloadResult, evaluate_payload
from cellctl.force.gravity.pose_file import PoseRecord

_FACTORS = {
    1e3: "forces look like kN where N belong",
    9.80665: "forces look like kgf where N belong",
    1e-3: "forces look like mN where N belong",
}
"""Unit that was probably written, by the ratio of the stated mass over the identified one."""
_NEAR = 0.2
"""Relative distance within which a ratio counts as one of these: farther than any stated mass is
off, and nearer than the next of them."""
_NEAREST_M, _FARTHEST_M = 1e-3, 3.0
"""The centre of mass of what hangs on a sensor is farther from it than a millimetre, and nearer
than any gripper with its part is long."""
_LIGHTEST_KG = 1.0
"""A load that is identified as lighter than this was probably written in kN: no gripper with a part
is so light."""


def unit_hint(result: PayloadResult, stated_mass_kg: float | None) -> str:
    """Which unit was probably written in place of the one that the column says; empty for none."""
    rigid = result.identification.rigid
    # The stated mass tells the unit of the forces at once. Without it the centre of mass does:
    # moments over forces, so it is off by a thousand when one of the two has the wrong unit.
    if stated_mass_kg is not None:
        for factor, words in _FACTORS.items():
            if abs(stated_mass_kg / rigid.mass_kg / factor - 1.0) < _NEAR:
                return words
    away_m = float(np.linalg.norm(rigid.centre_of_mass_m))
    if away_m > _FARTHEST_M:
        light = rigid.mass_kg < _LIGHTEST_KG
        meant = "forces look like kN where N belong" if light else "moments look like N·mm"
        return f"{meant}: the centre of mass would be {away_m:.3g} m from the sensor"
    if away_m < _NEAREST_M:
        return f"moments look like kN·m: the centre of mass would be {away_m * 1e3:.2g} mm away"
    return ""


def scalar_first_hint(record: PoseRecord) -> str:
    """A hint when the poses go together with the real part of the quaternion first; else empty."""
    written = record.base_R_sensor.as_quat()
    other = replace(record, base_R_sensor=Rotation.from_quat(np.roll(written, -1, axis=1)))
    try:
        accepted = evaluate_payload(other).accepted
    except CellError:
        return ""
    if not accepted:
        return ""
    return "with the columns as qw,qx,qy,qz the poses go together: the real part belongs last"
