"""Makes the two-file core and the packages of embedded tools from core_c; needs Python alone."""
