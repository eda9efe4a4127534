"""How far arms of this maker reach, by the model in the name that their controllers give.

The names of the series have it: SR500A-360/2.83 carries 360 kg and reaches 2.83 m, which is from
A1 to the middle of the wrist with the arm stretched. The maker's data sheets were not at hand: the
figures are of resellers' lists, which differ from each other by up to 40 mm.
"""

_REACH_M = {"SR500A": 2.83, "SR210A": 2.65, "SR50A": 2.15, "SR25A": 1.80}


def published_reach_m(robot_name: str) -> float | None:
    """Reach of the wrist in m; None for a name that begins with no known model."""
    models = [model for model in _REACH_M if robot_name.startswith(model)]
    return _REACH_M[models[0]] if models else None
