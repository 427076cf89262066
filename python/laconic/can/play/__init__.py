"""`laconic play`: the vehicle behind drives, or behind any DBC, for a controller that someone else wrote."""
