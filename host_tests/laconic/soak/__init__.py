"""Long runs: `laconic soak WHAT` calls the module of that name, with a function `soak(minutes, seed, advance)`."""
