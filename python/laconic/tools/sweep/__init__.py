"""`laconic sweep`: many runs of one scene with some of its keys varied."""
