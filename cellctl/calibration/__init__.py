"""Calibrations as pure functions: data in; result with residuals, covariance and verdict out.

Every result is a frozen dataclass with ``checks`` (figures against limits), ``passed``,
``method`` and ``to_record()``/``from_record()`` for the store. Pictures live in ``picture``.
"""
