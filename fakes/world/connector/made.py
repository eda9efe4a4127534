"""Connectors as they come from production: drawn from a seed, with the flaws that are asked for."""

from collections.abc import Collection, Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.world.connector.drawing import DRAWINGS, ConnectorDrawing, ContactKind
from fakes.world.connector.scene import (
    SceneConnector,
    SceneContact,
    SceneDirt,
    SceneMark,
    SceneMarks,
    Tip,
)
from fakes.world.frames import Array, stream

_SHINE_SPREAD = 0.05
_MARK_M = 2.0e-3
_FINGER_M = (9.0e-3, 22.0e-3)


def connector_as_made(
    name: str,
    kind: ContactKind,
    *,
    seed: int,
    camera_T_connector: RigidTransform,
    true_position_m: float = 10e-6,
    bent_m: Mapping[str, tuple[float, float]] | None = None,
    missing: Collection[str] = (),
    blocked: Collection[str] = (),
    dirt: int = 0,
    tip: Tip = "chamfer",
    housing_m: tuple[float, float] = (34e-3, 18e-3),
) -> SceneConnector:
    """One connector of a kind of ``DRAWINGS``.

    ``true_position_m`` is the standard deviation of every contact's place per axis; ``bent_m``
    moves tips away from their roots; ``missing`` and ``blocked`` name contacts; ``dirt`` counts
    specks. Raises ``KeyError`` for a name that the drawing does not have.
    """
    drawing = DRAWINGS[name]
    nominal = drawing.positions_m(kind)
    bends = dict(bent_m or {})
    unknown = {*bends, *missing, *blocked} - nominal.keys()
    if unknown:
        raise KeyError(f"no contacts {sorted(unknown)} on {name}")
    offsets = stream(seed, name, "contacts").normal(0.0, true_position_m, (len(nominal), 2))
    shine = stream(seed, name, "shine").normal(1.0, _SHINE_SPREAD, len(nominal))
    contacts = tuple(
        SceneContact(
            contact,
            (place[0] + float(offset[0]), place[1] + float(offset[1])),
            bends.get(contact, (0.0, 0.0)),
            present=contact not in missing,
            blocked=contact in blocked,
            shine=float(bright),
        )
        for (contact, place), offset, bright in zip(nominal.items(), offsets, shine, strict=True)
    )
    # All specks are drawn one after the other from one stream, so that another speck leaves the
    # first ones where they were.
    specks = tuple(_speck(drawing, rng) for rng in [stream(seed, name, "dirt")] * dirt)
    return SceneConnector(
        name, kind, camera_T_connector, drawing, contacts, housing_m, tip, specks, seed
    )


def gripper_marks(camera_T_marks: RigidTransform, *, reach_m: float = 24e-3) -> SceneMarks:
    """Five marks on two fingers, three on the one at +x: half a turn gives another picture.

    ``reach_m`` is the distance of the fingers' middle from the origin, along x.
    """
    width, height = _FINGER_M
    places = {
        "M1": (-reach_m, 7e-3),
        "M2": (-reach_m, -7e-3),
        "M3": (reach_m, 7e-3),
        "M4": (reach_m, -7e-3),
        "M5": (reach_m, 2e-3),
    }
    plates = tuple((side * reach_m, 0.0, width, height) for side in (-1.0, 1.0))
    marks = tuple(SceneMark(name, place, _MARK_M) for name, place in places.items())
    return SceneMarks("gripper", camera_T_marks, plates, marks)


def _speck(drawing: ConnectorDrawing, rng: np.random.Generator) -> SceneDirt:
    """A speck of dirt in the plane z = 0, of random place, size, outline and brightness."""
    sides: Array = np.array(drawing.insulator_m[:2])
    x, y = rng.uniform(-0.5, 0.5, 2) * sides
    waves = rng.uniform(-0.25, 0.25, 2)
    return SceneDirt(
        (float(x), float(y), 0.0),
        float(rng.uniform(0.04e-3, 0.2e-3)),
        (float(waves[0]), float(waves[1])),
        float(rng.uniform(0, 2 * np.pi)),
        float(rng.choice([0.03, 0.5])),
        float(rng.uniform(0.6, 1.0)),
    )
