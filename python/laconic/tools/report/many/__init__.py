"""Many vehicles at once beside other programs that step many: the same Runge-Kutta in numba and JAX, MuJoCo."""
