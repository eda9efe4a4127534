"""A part as the camera sees it: finish, wear, holes."""

import numpy as np

from fakes.render.bodies.clutter import draw_clutter
from fakes.render.bodies.faces import draw_face, draw_sides
from fakes.render.bodies.holes import hole_patch
from fakes.render.bodies.texture import brushed_tile, sample
from fakes.render.optics.canvas import Image, Patch
from fakes.render.optics.lens import View, undistort
from fakes.render.optics.surface import face_map, meet_surface, to_pixels
from fakes.render.options import RenderOptions
from fakes.world.scene import SceneHole, ScenePlate


def draw_plate(
    view: View,
    image: Image,
    plate: ScenePlate,
    options: RenderOptions,
    *,
    light_azimuth: float,
    blur_px: float,
    below: ScenePlate | None = None,
    above: ScenePlate | None = None,
) -> list[Patch]:
    """Lay the face of a part over ``image``; its holes are returned, blurred, for later.

    ``below`` is the part that shows through its through holes. ``above`` is a part that will be
    laid over this one: when it hides all holes in view, details are not worth their time.
    """
    pose, level = plate.camera_T_part, plate.brightness * options.plate_grey
    holes = [hole for hole in plate.holes if _is_near(view, plate, hole)]
    shown = [hole for hole in holes if above is None or not _is_hidden(view, plate, hole, above)]
    x, y = face_map(view, pose)
    draw_sides(
        view,
        image,
        pose=pose,
        size_m=plate.size_m,
        thickness_m=plate.thickness_m,
        grey=0.4 * level,
        seen_m=(np.array([x.min(), y.min()]), np.array([x.max(), y.max()])),
    )
    # Nothing of it can be measured, so a plain face is enough.
    if above is not None and not shown:
        draw_face(image, x, y, plate.size_m, level)
        return []
    face: Image | float = level
    if options.texture_grey > 0:
        face = sample(brushed_tile(plate.seed), x, y)
        # These operations work in place, because each of these arrays has five million pixels.
        face *= np.float32(options.texture_grey)
        face += np.float32(level)
    draw_face(image, x, y, plate.size_m, face)
    draw_clutter(view, image, plate, options, light_azimuth)
    patches = (
        hole_patch(
            view, plate, hole, options, light_azimuth=light_azimuth, blur_px=blur_px, below=below
        )
        for hole in shown
    )
    return [patch for patch in patches if patch is not None]


def _is_hidden(view: View, plate: ScenePlate, hole: SceneHole, above: ScenePlate) -> bool:
    """True when the ray to a hole meets the face of the part above, away from its edges."""
    centre = np.array([[*hole.position_m, 0.0]])
    ray = undistort(view.lens, to_pixels(view, plate.camera_T_part, centre))
    place = meet_surface(view.view_T_head * above.camera_T_part, ray, 0.0)[0]
    return bool((np.abs(place) < np.array(above.size_m) / 2 - 10e-3).all())


def _is_near(view: View, plate: ScenePlate, hole: SceneHole) -> bool:
    """False for holes so far outside that the lens model does not hold for them."""
    pose = plate.camera_T_part
    centre = np.array([[*hole.position_m, 0.0]])
    in_view = (view.view_T_head * pose).apply(centre)[0]
    if in_view[2] <= 0 or np.hypot(*in_view[:2]) > 0.6 * in_view[2]:
        return False
    pixel = to_pixels(view, pose, centre)[0]
    return bool((pixel > -200).all() and (pixel < np.array(view.size_px) + 200).all())
