"""Schemas of the JSON messages: there is no common one for forces, registers or figures."""

from collections.abc import Mapping
from typing import Any

Schema = Mapping[str, Any]

NUMBER: Schema = {"type": ["number", "null"]}
INTEGER: Schema = {"type": ["integer", "null"]}
TEXT: Schema = {"type": ["string", "null"]}
FLAG: Schema = {"type": ["boolean", "null"]}
NUMBERS: Schema = {"type": ["array", "null"], "items": NUMBER}
OBJECT: Schema = {"type": ["object", "null"]}

_WRENCH = ("fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
_POSE = ("x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg")
_STATE_TEXTS = ("state", "state_requested", "mode", "step_label", "message")


def _fields(kind: Schema, *names: str) -> dict[str, Schema]:
    return dict.fromkeys(names, kind)


FIELDS: Mapping[str, Mapping[str, Schema]] = {
    "cellctl.Force": _fields(NUMBER, "time_s", *_WRENCH),
    "cellctl.ContactForce": _fields(NUMBER, "time_s", "travel_mm", *_WRENCH),
    "cellctl.RobotReport": {
        **_fields(NUMBER, "time_s", *_POSE, "override_ratio"),
        **_fields(FLAG, "moving", "stop_latched"),
        "joints_rad": NUMBERS,
        "error_code": INTEGER,
    },
    "cellctl.RobotCommand": {
        **_fields(NUMBER, "time_s", "speed_ratio", "speed_mm_s", "acceleration_mm_s2"),
        **_fields(NUMBERS, "joints_rad", "base_T_flange_mm_deg"),
        "what": TEXT,
    },
    "cellctl.UnitState": {
        "time_s": NUMBER,
        **_fields(TEXT, *_STATE_TEXTS),
        **_fields(INTEGER, "step", "iteration"),
    },
    "cellctl.Registers": {"time_s": NUMBER},
    "cellctl.Command": {**_fields(TEXT, "action", "who"), "detail": OBJECT},
    "cellctl.Step": {"number": INTEGER, **_fields(TEXT, "label", "event")},
    "cellctl.Alarm": {"number": INTEGER, **_fields(TEXT, "text", "event", "who")},
    "cellctl.Figure": {
        **_fields(TEXT, "key", "label", "unit", "verdict"),
        **_fields(NUMBER, "value", "lower", "upper"),
    },
    "cellctl.LoopPass": {
        "loop": TEXT,
        "number": INTEGER,
        "converged": FLAG,
        "residual_um": NUMBER,
        "frames": INTEGER,
        "components": OBJECT,
    },
    "cellctl.Pose": {
        **_fields(TEXT, "key", "origin", "parent", "child"),
        **_fields(NUMBER, *_POSE, "residual_um"),
        "sigma_mm_deg": NUMBERS,
        "frames": INTEGER,
        "detail": OBJECT,
    },
    "cellctl.Rims": {
        **_fields(TEXT, "look", "view"),
        "rims": {"type": "array", "items": {"type": "object"}},
    },
}
"""Fields of each schema. A further field of a message is allowed: a later release may record more,
and the names of registers are those of the register map."""


def json_schema(name: str) -> dict[str, Any]:
    """The schema as it stands in the file; raises ``KeyError`` for a name without one."""
    return {"title": name, "type": "object", "properties": dict(FIELDS[name])}
