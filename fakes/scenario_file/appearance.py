"""The section of a scenario file that says how parts and plates look."""

from fakes.scenario_file.sections import Pair, Section


class Rendering(Section):
    """Appearance; levels are grey values 0 to 255."""

    plate_level: float
    background_level: float
    hole_level: float
    wall_visibility: float
    """Brightness of a hole's wall, 0 as dark as the hole, 1 as bright as the plate."""
    recessed_rims: bool = False
    """The rim that carries the centre of a countersunk or chamfered hole lies below the face, as
    machined; the feature files of the cell must say so. Else the ring round it is flat."""
    countersink_levels: Pair
    """Darkest and brightest azimuth, relative to the plate."""
    thread_levels: Pair
    light_gradient: float
    """Relative change of light from one side of the image to the other."""
    texture_levels: float
    read_noise_levels: float
    electrons_per_level: float
    """Sets the shot noise."""
    scratches: int
    false_circles: int
    board_dark_level: float
    board_bright_level: float
