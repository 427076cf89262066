"""Pictures of runs: curves, and how methods look in them."""
