"""`laconic optimise`: numbers of a scene by stated goals; the search is SciPy's, what is measured the core's."""
