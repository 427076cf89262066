"""How far the project is checked beyond its tests; `build/venv/bin/python host_tests/assurance` lists the parts."""
