"""Commands that set cameras up: they open one device of a cell file and no other."""
