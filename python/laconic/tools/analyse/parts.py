"""The parts of an analysis in their order, without the libraries that they need."""

GEOMETRY = "geometry"
TITLES = {GEOMETRY: "Geometry", "free": "Free motion", "steady": "Steady motions", "bifurcation": "Bifurcations",
          "traction": "Traction"}
PARTS = tuple(TITLES)
