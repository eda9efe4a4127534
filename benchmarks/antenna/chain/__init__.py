"""Where plugs come to lie, in drawn cells: without images, with the noise that images were measured
to have. The campaign's requirements are those of the process; its truth is the drawn cell's.

- ``arms``: a six-axis arm that is not what its controller believes, and warms up
- ``optics``: contacts into pixels by the true camera, back to a pose by the believed one
- ``drawn_cell``: a whole cell, calibrated by the package's own hand-eye solver
- ``trials``: teaching and plugging by every scheme, in the same draws
- ``campaign``: the table against what is demanded
"""
