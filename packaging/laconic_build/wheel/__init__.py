"""From a build tree, or from sources and a cross compiler, to wheels that need neither."""
