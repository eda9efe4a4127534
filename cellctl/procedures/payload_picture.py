"""The residuals of a payload identification as a picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.drawing import as_png, new_figure
from cellctl.force.gravity.payload_result import PayloadResult
from cellctl.geometry.pose import Array
from cellctl.plot_style import ACCENT, INK, MUTED, SECOND, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@style()
def residual_picture(result: PayloadResult) -> bytes:
    """PNG: forces above, torques below; bars of both models, dots for left-out predictions."""
    rigid, affine = result.identification.rigid, result.identification.affine
    figure = new_figure(10.0, 6.0)
    rows = figure.subplots(2, 3, sharex=True, sharey="row")
    for index, name in enumerate(("Fx", "Fy", "Fz", "Mx", "My", "Mz")):
        axes = rows[index // 3][index % 3]
        _bars(axes, rigid.residual[:, index], affine.residual[:, index])
        poses = np.arange(1, len(affine.left_out) + 1)
        axes.plot(poses, affine.left_out[:, index], ".", label="affine24, pose left out", color=INK)
        axes.set_title(f"{name} / {'N' if index < 3 else 'N·m'}")
        axes.axhline(0.0, color=MUTED, linewidth=0.8)
    for axes in rows[1]:
        axes.set_xlabel("pose")
    rows[0][0].legend(fontsize="small")
    verdict = "accepted" if result.accepted else "NOT accepted"
    figure.suptitle(f"Payload {rigid.mass_kg:.2f} kg, {len(affine.residual)} poses, {verdict}")
    return as_png(figure)


def _bars(axes: "Axes", rigid: Array, affine: Array) -> None:
    poses = np.arange(1, len(rigid) + 1)
    axes.bar(poses - 0.2, rigid, width=0.4, color=SECOND, label="rigid12")
    axes.bar(poses + 0.2, affine, width=0.4, color=ACCENT, label="affine24")
