"""How long the commands of cellctl take that compute nothing."""
