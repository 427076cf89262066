"""Generators that the build runs: wire tables, two-file C and packages, wheels, npm package and page, site, release."""
