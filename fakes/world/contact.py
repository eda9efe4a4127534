"""Where the deck can touch the frame: pads round its rim, pins, foreign bodies, chamfers."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenario import Scenario
from fakes.world.frames import MM, Array
from fakes.world.pins import pin_faces
from fakes.world.suspension import Contacts, Rows
from fakes.world.truth import PartsTruth

OUT_OF_REACH_M = 1.0
_BODY_SHARE = 0.5
"""Stiffness of a foreign body or a chamfer relative to all pads together."""


@dataclass(frozen=True, slots=True)
class Rim:
    """Contact points: places in the deck's frame, directions and anchors in the frame's."""

    points_m: Array
    directions: Array
    anchors_m: Array
    stiffness_n_m: Array
    half_size_m: Array
    wedges: Rows
    """Shape (m, 3): rows that together bound one convex obstacle, its top last."""
    ahead: "np.ndarray[tuple[int], np.dtype[np.bool_]]"
    """Shape (n,): rows that are met along the approach. Beside a pin its wall is always near."""

    def gaps(self, frame_T_deck: Array) -> Array:
        """Distance of each point to what it can touch, shape (n,); ``frame_T_deck`` is 4x4."""
        places = self.points_m @ frame_T_deck[:3, :3].T + frame_T_deck[:3, 3]
        over = np.abs(frame_T_deck[:2, 3]) < self.half_size_m
        if not over.all():
            return np.full(len(places), OUT_OF_REACH_M)
        return np.asarray(((places - self.anchors_m) * self.directions).sum(axis=1))

    def distance(self, gaps: Array) -> float:
        """Height above whatever is met first."""
        return float(gaps[self.ahead].min())

    def contacts(self, com_T_deck: RigidTransform, damping_ratio: float, mass: float) -> Contacts:
        """The same points as seen from the centre of mass, in tool axes."""
        places = com_T_deck.apply(self.points_m)
        directions = com_T_deck.rotation.apply(self.directions)
        jacobian = np.hstack([directions, np.cross(places, directions)])
        stiffness = self.stiffness_n_m
        together = stiffness.copy()
        carrying = np.ones(len(stiffness), dtype=bool)
        carrying[self.wedges] = False
        together[carrying] = stiffness[carrying].sum()
        damping = 2 * damping_ratio * np.sqrt(mass / together) * stiffness
        return Contacts(jacobian, stiffness, damping, self.wedges)


def rim(scenario: Scenario, parts: PartsTruth, faults: FaultBoard) -> Rim:
    """Contact points of loaded parts and of injected obstacles."""
    pads = _pads(scenario)
    count = len(pads)
    points = np.column_stack([pads, np.full(count, -parts.deck_thickness_m)])
    directions = np.tile([0.0, 0.0, 1.0], (count, 1))
    anchors = np.zeros((count, 3))
    stiffness = np.full(count, parts.contact_stiffness_n_m / count)
    for name in ("foreign_body", "pin_catch"):
        fault = faults.active(name)
        if fault is None:
            continue
        x = fault.number("x_mm", -480.0) * MM
        y = fault.number("y_mm", -180.0) * MM
        slope = np.deg2rad(fault.number("slope_deg", 45.0 if name == "pin_catch" else 0.0))
        height = fault.number("height_mm", 6.0 if name == "pin_catch" else 1.0) * MM
        points = np.vstack([points, [x, y, -parts.deck_thickness_m]])
        directions = np.vstack([directions, [np.sin(slope), 0.0, np.cos(slope)]])
        anchors = np.vstack([anchors, [x, y, height]])
        stiffness = np.append(stiffness, _BODY_SHARE * parts.contact_stiffness_n_m)
    wedges = Contacts.none().wedges
    if scenario.contact.pins is not None:
        faces = pin_faces(scenario.contact.pins, parts)
        wedges = np.arange(len(faces.points_m)).reshape(-1, 3) + len(points)
        points = np.vstack([points, faces.points_m])
        directions = np.vstack([directions, faces.directions])
        anchors = np.vstack([anchors, faces.anchors_m])
        pin_stiffness = np.full(len(faces.points_m), scenario.contact.pins.stiffness_n_m)
        stiffness = np.append(stiffness, pin_stiffness)
    half_size = np.array(scenario.parts.size_mm) / 2 * MM
    ahead = np.ones(len(points), dtype=bool)
    ahead[wedges[:, :2]] = False
    return Rim(points, directions, anchors, stiffness, half_size, wedges, ahead)


def _pads(scenario: Scenario) -> Array:
    """Places round the rim: corners and middles of the sides for eight pads."""
    inset = scenario.contact.rim_inset_mm
    half = (np.array(scenario.parts.size_mm) / 2 - inset) * MM
    angles = 2 * np.pi * np.arange(scenario.contact.pads) / scenario.contact.pads
    square = np.column_stack([np.cos(angles), np.sin(angles)])
    square /= np.abs(square).max(axis=1, keepdims=True)
    return square * half
