"""Makes build/page/laconic.html and the npm package, byte for byte the same at every run."""
