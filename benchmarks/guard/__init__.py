"""How long the guard takes from a sample to a stop, beside a baseline in one process."""
