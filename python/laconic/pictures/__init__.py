"""Pictures of runs: curves, and the style of each method."""
