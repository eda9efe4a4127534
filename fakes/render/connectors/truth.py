"""Exact truth of a picture of connectors: where every contact and mark is."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import to_pixels
from fakes.world.connector.scene import SceneConnector, SceneMarks

ContactState = Literal["ok", "bent", "missing", "blocked"]
_BENT_M = 0.02e-3
"""A tip that is off by more than this is called bent: more than any true position."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactTruth:
    """One pin (where its full section begins) or one hole (its middle at the face)."""

    state: ContactState
    connector_m: Array
    """Position in the frame of its connector, shape (3,); z is zero."""
    camera_m: Array
    """Position in the frame of the camera, shape (3,)."""
    px: Array
    """Its centre, projected, shape (2,); pixel centres lie at integers."""


@dataclass(frozen=True, slots=True, eq=False)
class MarkTruth:
    """One mark of the gripper."""

    marks_m: Array
    camera_m: Array
    px: Array


@dataclass(frozen=True, slots=True)
class ConnectorTruth:
    """One connector of a picture."""

    camera_T_connector: RigidTransform
    """The frame of the drawing; true positions of contacts are not fitted into it."""
    contacts: dict[str, ContactTruth]


def contact_truths(view: View, connector: SceneConnector) -> dict[str, ContactTruth]:
    """Truths by the name of the contact; one that is missing stands where it would be."""
    points = np.array([[*contact.centre_m, 0.0] for contact in connector.contacts])
    camera = connector.camera_T_connector.apply(points)
    pixels = to_pixels(view, connector.camera_T_connector, points)
    states: list[ContactState] = []
    for contact in connector.contacts:
        if not contact.present:
            states.append("missing")
        elif contact.blocked:
            states.append("blocked")
        else:
            states.append("bent" if np.hypot(*contact.bend_m) > _BENT_M else "ok")
    return {
        contact.name: ContactTruth(state, *places)
        for contact, state, *places in zip(
            connector.contacts, states, points, camera, pixels, strict=True
        )
    }


def mark_truths(view: View, marks: SceneMarks) -> dict[str, MarkTruth]:
    """Truths by the name of the mark."""
    points = np.array([[*mark.position_m, 0.0] for mark in marks.marks])
    camera = marks.camera_T_marks.apply(points)
    pixels = to_pixels(view, marks.camera_T_marks, points)
    return {
        mark.name: MarkTruth(*places)
        for mark, *places in zip(marks.marks, points, camera, pixels, strict=True)
    }
