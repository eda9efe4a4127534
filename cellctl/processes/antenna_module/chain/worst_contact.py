"""How far the worst contact of a plug lies from its hole."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array

_DRAWS = 40_000
"""Number of random draws, which makes the 99th percentile good to half a per cent."""
_SEED = 20_130
"""Any number, as long as it stays: see ``predict_worst_contact``."""


@dataclass(frozen=True, slots=True)
class WorstContact:
    """Predicted distances in the plane of the connector."""

    p99_m: float
    """99 of 100 plugs have all their contacts within this distance."""
    name: str
    """The contact that is worst most often."""


def contact_offsets(errors: Array, contacts_m: Array) -> Array:
    """Distances of contacts from their holes, shape (n, k).

    ``errors``: x, y (m) and rz (rad) of ``socket_T_plug``, shape (n, 3); ``contacts_m``: x, y of
    the k contacts in the frame of the connector, shape (k, 2).
    """
    turned = np.stack([-contacts_m[:, 1], contacts_m[:, 0]], axis=1)
    moved = errors[:, None, :2] + errors[:, None, 2:] * turned[None]
    return np.asarray(np.linalg.norm(moved, axis=2))


def predict_worst_contact(
    covariance: Array, contacts_m: Array, names: tuple[str, ...]
) -> WorstContact:
    """From the 6x6 covariance of ``socket_T_plug`` in the axes of the socket.

    Drawn, because the largest of several dependent distances has no closed form. The draws are
    the same every time, so that one plan always gives one figure.
    """
    planar = covariance[np.ix_([0, 1, 5], [0, 1, 5])]
    # By eigenvectors and not by Cholesky: a cell without noise in yaw is legitimate.
    values, vectors = np.linalg.eigh(planar)
    root = vectors * np.sqrt(np.clip(values, 0.0, None))
    errors = np.random.default_rng(_SEED).standard_normal((_DRAWS, 3)) @ root.T
    offsets = contact_offsets(errors, contacts_m)
    counts = np.bincount(offsets.argmax(axis=1), minlength=len(contacts_m))
    p99_m = float(np.quantile(offsets.max(axis=1), 0.99))
    return WorstContact(p99_m, names[int(counts.argmax())])
