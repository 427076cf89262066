"""The benchmark: accuracy, speed, sizes and faults of everything that the project makes, as a report.

`many` steps many vehicles at once beside other programs: the same Runge-Kutta in numba and JAX, and MuJoCo.
"""
