"""The benchmark: accuracy, speed, sizes and faults of everything that the project makes, as a report."""
