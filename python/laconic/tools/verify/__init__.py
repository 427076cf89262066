"""The core against references: trajectories of 25 digits, and the equations once more in numpy.

`exact` has steps and motions in 50 digits, from the equations alone. They share no code with the core.
"""
