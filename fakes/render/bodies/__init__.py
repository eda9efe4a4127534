"""How plates with holes, boards and prints look."""
