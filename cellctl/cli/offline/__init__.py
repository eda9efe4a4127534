"""Commands that work on files, without a cell and without a daemon."""
