"""What the run store keeps as files beside its database: curves, motion, images.

``artefacts`` names each file by the SHA-256 of its bytes; ``curve_file`` and ``motion_file`` are
recordings as MCAP. ``disk_space`` is asked before a run whether all of it will fit.
"""
