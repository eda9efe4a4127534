"""Where the deck can touch the frame: pads round its rim, pins, burrs, foreign bodies, chamfers."""

import numpy as np

from fakes.faults import FaultBoard
from fakes.scenes.deck_on_frame.flex import hang_m
from fakes.scenes.deck_on_frame.parts import PartsTruth
from fakes.scenes.deck_on_frame.pins import DIRECTIONS, pin_faces
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.frames import MM, Array
from fakes.world.load.contact import ContactPoints
from fakes.world.load.suspension import Contacts

_DOWEL_N_M = 1e6
"""A steel dowel jammed in its hole; the arm behind it is no stiffer."""
_BODY_SHARE = 0.5
"""Stiffness of a foreign body, a burr or a chamfer relative to all pads together."""


def rim(scenario: DeckScenario, parts: PartsTruth, faults: FaultBoard) -> ContactPoints:
    """Contact points of loaded parts and of injected obstacles."""
    anchors, stiffness = _resting(scenario, parts)
    points = np.column_stack([anchors[:, :2], np.full(len(anchors), -parts.deck_thickness_m)])
    directions = np.tile([0.0, 0.0, 1.0], (len(anchors), 1))
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
    holding = np.zeros(len(points), dtype=bool)
    if dowel := faults.active("held_dowel"):
        place = [dowel.number("x_mm", 0.0) * MM, dowel.number("y_mm", 0.0) * MM]
        points = np.vstack([points, [*place, -parts.deck_thickness_m]])
        directions = np.vstack([directions, [0.0, 0.0, 1.0]])
        anchors = np.vstack([anchors, [*place, dowel.number("height_mm", 0.0) * MM]])
        stiffness = np.append(stiffness, dowel.number("stiffness_n_m", _DOWEL_N_M))
        holding = np.append(holding, True)
    wedges = Contacts.none().wedges
    if scenario.contact.pins is not None:
        faces = pin_faces(scenario.contact.pins, parts)
        wedges = np.arange(len(faces.points_m)).reshape(-1, DIRECTIONS, 3) + len(points)
        points = np.vstack([points, faces.points_m])
        directions = np.vstack([directions, faces.directions])
        anchors = np.vstack([anchors, faces.anchors_m])
        pin_stiffness = np.full(len(faces.points_m), scenario.contact.pins.stiffness_n_m)
        stiffness = np.append(stiffness, pin_stiffness)
    points[:, 2] -= hang_m(scenario, points[:, :2])
    half_size = np.array(scenario.parts.size_mm) / 2 * MM
    ahead = np.ones(len(points), dtype=bool)
    ahead[wedges[..., :2]] = False
    holding = np.append(holding, np.zeros(len(points) - len(holding), dtype=bool))
    return ContactPoints(points, directions, anchors, stiffness, half_size, wedges, ahead, holding)


def _resting(scenario: DeckScenario, parts: PartsTruth) -> tuple[Array, Array]:
    """Where the deck rests on the frame, and the stiffness there: pads, and a burr beside them."""
    pads = _pads(scenario)
    anchors = np.column_stack([pads, np.zeros(len(pads))])
    stiffness = np.full(len(pads), parts.contact_stiffness_n_m / len(pads))
    if parts.burr_m is not None:
        anchors = np.vstack([anchors, parts.burr_m])
        stiffness = np.append(stiffness, _BODY_SHARE * parts.contact_stiffness_n_m)
    return anchors, stiffness


def _pads(scenario: DeckScenario) -> Array:
    """Places round the rim: corners and middles of the sides for eight pads."""
    inset = scenario.contact.rim_inset_mm
    half = (np.array(scenario.parts.size_mm) / 2 - inset) * MM
    angles = 2 * np.pi * np.arange(scenario.contact.pads) / scenario.contact.pads
    square = np.column_stack([np.cos(angles), np.sin(angles)])
    square /= np.abs(square).max(axis=1, keepdims=True)
    return square * half
