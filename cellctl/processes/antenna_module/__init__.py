"""An antenna module plugged into its socket by two cameras and a force sensor."""
