"""From modelDescription.xml to C tables, descriptions and FMUs."""
