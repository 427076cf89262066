"""The core against references: trajectories of 25 digits, and the equations once more in numpy."""
