"""A camera on or beside a robot: closed form, then maximum likelihood."""
