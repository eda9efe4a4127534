"""Figures of a recipe that are possible and in all likelihood slips; a daemon takes them."""
