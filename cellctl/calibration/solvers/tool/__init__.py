"""A tool on a flange, from poses that touch points."""
