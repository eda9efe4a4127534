"""The demonstration: fake cell, daemon and line PLC as processes, watched in a terminal."""
