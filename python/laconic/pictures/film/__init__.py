"""Films of runs: a moving picture as one SVG file, which browsers and code hosts play without a script."""
