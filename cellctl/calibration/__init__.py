"""Calibrations: solvers that compute them, and the store that keeps them.

The walk of one calibration: ``boards`` finds a board in images or targets, a package of
``solvers`` computes the result, ``checks`` hold its figures against limits, a picture shows the
evidence, and ``store`` keeps the record on disk until production reads it. Solvers are pure
functions: data in; result with residuals, covariance and verdict out. The procedures of
Maintenance mode and ``cellctl calibrate`` call the same functions (docs/calibration.md).

What each kind of calibration is called, who makes it and what invalidates it are data of the
process that needs it (``store.kind``): nothing in this package names one.
"""
