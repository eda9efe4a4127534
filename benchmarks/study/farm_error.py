"""What is said when the workers cannot be used; apart, because Dask may be missing."""


class FarmError(RuntimeError):
    """A sentence for the user."""
