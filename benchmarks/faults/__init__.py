"""Every fault of the fake cell in every phase in which something moves or is in contact."""
