"""The cell file as it is written: lines, spelling, and the keys that the models know."""
