"""The model of a cell: a file beside the cell file, ``deck.model.toml`` beside ``deck.toml``."""
