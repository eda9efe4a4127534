"""The scenario file of a fake cell: what it may say, section by section."""
