"""How many terms of the lens are adjusted, decided by views that the calibration has not seen.

Five terms describe most lenses that measure. A wide one, or one that sits askew before its sensor,
leaves more than noise; but terms that a lens does not need take up noise and bend the image where
no board was. So the longer models are tried in their order, and one is taken only when views that
were held out are measured better by it.
"""

from collections.abc import Callable

from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.solvers.shape_choice import WORTH, R
from cellctl.errors.calibration import SolveFailed


def chosen_lens(
    calibrate: Callable[[LensModel], R], held_out: Callable[[R], float | None]
) -> tuple[LensModel, str]:
    """The lens that the data ask for, and why, for the ``method`` of the result.

    ``held_out`` gives the error of a result for views that it has not seen, None when there were
    too few to hold any back.
    """
    best = LensModel.FIVE
    plain = held_out(calibrate(best))
    if plain is None:
        return best, "too few views to try lenses of more terms"
    least, said = plain, []
    for lens in (LensModel.RATIONAL, LensModel.THIN_PRISM, LensModel.TILTED):
        try:
            error = held_out(calibrate(lens))
        except SolveFailed:
            # A model with more terms than the views determine is none that they ask for.
            error = None
        if error is None:
            said.append(f"{lens.terms} terms have no solution")
            continue
        said.append(f"{error / plain:.3f} with {lens.terms} terms")
        if error <= WORTH * least:
            best, least = lens, error
    return best, f"held-out error over that of a lens of 5 terms: {', '.join(said)}"
