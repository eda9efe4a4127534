"""Figures of a recipe and its cell that are possible and in all likelihood slips; a daemon takes
them."""
