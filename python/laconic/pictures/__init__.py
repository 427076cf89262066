"""Pictures of runs: curves, and the style of each method.

`film` makes a moving picture of a run: one SVG file, which browsers and code hosts play without a script. `views`
shows a run in other programs.
"""
