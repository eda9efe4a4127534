"""`cellctl fleet`: the records of many cells in one database."""
