"""The lamp of a camera, as the scenario gives it, is in its pictures."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from fakes.render.connectors import api
from fakes.render.options import RenderOptions
from fakes.render.worker import render_frame
from fakes.scenario_file.sections import RingLamp
from fakes.world.scene import CameraScene

SIZE_PX = (360, 160)
OPTIONS = RenderOptions.clean()
PLUG = api.connector_as_made("micro-d-15", "pins", seed=3, camera_T_connector=api.facing())


def picture(lamp: RingLamp) -> NDArray[np.float64]:
    camera = api.nominal_camera(um_per_px=45.0, size_px=SIZE_PX)
    scene = CameraScene("camera", 0.0, camera, (PLUG,), light_seed=1, noise_seed=1, lamp=lamp)
    frame = render_frame(scene, OPTIONS)
    image = np.frombuffer(frame.payload, dtype=np.uint8).reshape(frame.height, frame.width, 3)
    return image.astype(float)


def test_half_the_light_is_half_as_bright() -> None:
    full, half = picture(RingLamp()), picture(RingLamp(brightness=0.5))
    unclipped = full < 250
    np.testing.assert_allclose(half[unclipped], full[unclipped] / 2, atol=0.6)


def test_a_lamp_at_one_side_lights_one_side_of_every_pin() -> None:
    ring = picture(RingLamp())
    left = picture(RingLamp(azimuth_deg=180.0, arc_deg=40.0))
    right = picture(RingLamp(azimuth_deg=0.0, arc_deg=40.0))
    assert np.abs(left - ring).max() > 20
    assert np.abs(left - right).max() > 20


def test_a_lamp_without_light_is_refused() -> None:
    with pytest.raises(ValidationError, match="brightness"):
        RingLamp(brightness=0.0)
