"""The calibrations of a cell on its disk.

``kind`` says what a calibration kind is; processes define theirs as data. ``store`` reads and
writes the folder, ``snapshot`` is what a run gets from it. Below them: ``envelope`` is one file,
``marker`` says that a file is invalid, ``validity`` counts the hours that are left, ``inventory``
lists what there is.
"""
