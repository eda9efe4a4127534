"""The HTTP API, one file for each subject; the paths are below ``/api/v1``."""
