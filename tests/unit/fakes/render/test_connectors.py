"""Pictures of connectors against their truth, measured without any model of the renderer."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from fakes.render.connectors import api
from fakes.render.connectors.look import ConnectorLook
from fakes.render.options import RenderOptions
from fakes.world.connector.drawing import DRAWINGS, SOCKET_T_MATED_PLUG

Array = NDArray[np.float64]
EVEN = RenderOptions.clean()
"""Options with even light and no noise."""
SMALL_PX = (760, 320)


def middle_of_brightness(image: NDArray[np.uint8], px: Array, reach: int = 13) -> Array:
    """Centroid of what is brighter than two fifths of the brightest round a place, px.

    The ground does not count: a dark wall before it would count as much as a bright one.
    """
    x0, y0 = np.rint(px).astype(int)
    part = image[y0 - reach : y0 + reach + 1, x0 - reach : x0 + reach + 1].astype(float)
    light = np.maximum(part - 0.4 * part.max(), 0)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    return np.array([x0 + (light * x).sum() / light.sum(), y0 + (light * y).sum() / light.sum()])


def offsets_um(picture: api.ConnectorPicture) -> Array:
    """Offsets of the centroids from the truth, for every contact that is there, shape (N, 2)."""
    truth = picture.connectors["micro-d-15"].contacts.values()
    found = [
        middle_of_brightness(picture.image, contact.px) - contact.px
        for contact in truth
        if contact.state != "missing"
    ]
    return 25.0 * np.array(found)


def plug_picture(
    look: ConnectorLook, shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> api.ConnectorPicture:
    plug = api.connector_as_made(
        "micro-d-15",
        "pins",
        seed=4,
        missing=("3",),
        bent_m={"6": (0.1e-3, 0.05e-3)},
        camera_T_connector=api.facing(shift_m=shift_m, yaw_deg=7.0),
    )
    # The ground is black because its own light moves edges, and differently beside a dark wall.
    plug = replace(plug, drawing=replace(plug.drawing, insulator_colour=(0.0, 0.0, 0.0)))
    camera = api.nominal_camera(size_px=SMALL_PX)
    return api.render(camera, [plug], look, seed=2)


def test_tips_lie_where_the_truth_says() -> None:
    look = ConnectorLook(wall_light=0.0, sensor=EVEN)
    picture = plug_picture(look)
    sizes_um = np.abs(offsets_um(picture)).max(axis=1)
    bent = [truth.state == "bent" for truth in picture.connectors["micro-d-15"].contacts.values()]
    # The third contact is missing. The flat of a leaning pin lies beside its shoulder.
    leaning = np.delete(bent, 2)
    assert sizes_um[~leaning].max() < 0.5
    assert sizes_um[leaning].max() < 1.0


def test_bright_walls_pull_towards_the_axis_and_dark_ones_do_not() -> None:
    shift_m = (4e-3, 0.0, 0.0)
    bright = offsets_um(plug_picture(ConnectorLook(wall_light=1.0, sensor=EVEN), shift_m))
    dark = offsets_um(plug_picture(ConnectorLook(wall_light=0.0, sensor=EVEN), shift_m))
    assert bright[:, 0].mean() < dark[:, 0].mean() - 2.0
    assert abs(dark[:, 0].mean()) < 1.0


def test_a_lamp_at_one_side_pulls_towards_it() -> None:
    lamps = api.Lamps(arc_deg=40.0, azimuth_rad=0.0)
    found = offsets_um(plug_picture(ConnectorLook(lamps, wall_light=0.0, sensor=EVEN)))
    assert found[:, 0].min() > 5.0
    assert np.abs(found[:, 1]).max() < 3.0


def test_states_are_named_and_the_same_seed_gives_the_same_picture() -> None:
    one, other = (plug_picture(ConnectorLook()) for _ in range(2))
    contacts = one.connectors["micro-d-15"].contacts
    assert {n: c.state for n, c in contacts.items() if c.state != "ok"} == {
        "3": "missing",
        "6": "bent",
    }
    assert np.array_equal(one.image, other.image)


def test_only_the_insulator_is_saturated() -> None:
    plug = api.connector_as_made("d-sub-15", "pins", seed=1, camera_T_connector=api.facing())
    picture = api.render(api.nominal_camera(size_px=(1300, 700)), [plug], pixels="rgb")
    saturation = cv2.cvtColor(picture.image, cv2.COLOR_RGB2HSV)[..., 1]
    middle, housing = saturation[340:360, 600:700], saturation[100:140, 200:1000]
    assert np.median(middle) > 150
    assert np.percentile(housing, 95) < 60


def test_green_pixels_of_a_mosaic_are_those_of_the_colour_image() -> None:
    socket = api.connector_as_made(
        "micro-d-15", "holes", seed=1, blocked=("5",), camera_T_connector=api.facing()
    )
    look, camera = ConnectorLook(sensor=EVEN), api.nominal_camera(size_px=SMALL_PX)
    colour = api.render(camera, [socket], look, pixels="rgb").image
    mosaic = api.render(camera, [socket], look, pixels="bayer").image
    assert np.array_equal(mosaic[0::2, 1::2], colour[0::2, 1::2, 1])
    assert np.array_equal(mosaic[0::2, 0::2], colour[0::2, 0::2, 0])
    places = api.render(camera, [socket], look).connectors["micro-d-15"].contacts
    green = colour[..., 1]
    levels = {n: int(green[tuple(np.rint(c.px[::-1]).astype(int))]) for n, c in places.items()}
    assert levels.pop("5") > 2 * max(levels.values())


def test_marks_lie_where_the_truth_says() -> None:
    marks = api.gripper_marks(api.facing(yaw_deg=3.0), reach_m=15e-3)
    camera = api.nominal_camera(size_px=(1400, 800))
    picture = api.render(camera, [marks], ConnectorLook(sensor=EVEN))
    for mark in picture.marks.values():
        found = middle_of_brightness(picture.image, mark.px, 50)
        assert found == pytest.approx(mark.px, abs=0.02)


def test_contacts_of_a_mated_pair_meet() -> None:
    for drawing in DRAWINGS.values():
        pins, holes = drawing.positions_m("pins"), drawing.positions_m("holes")
        for name, place in pins.items():
            met = SOCKET_T_MATED_PLUG.apply([*place, 0.0])
            assert met[:2] == pytest.approx(holes[name], abs=1e-12)
