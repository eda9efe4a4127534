"""A stereo head from views of a board: start values, bundle adjustment, cross-validation."""
