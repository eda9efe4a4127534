"""A fake cell and the daemon as processes of their own, driven from outside like by a line."""
