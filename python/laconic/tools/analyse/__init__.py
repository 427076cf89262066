"""Properties of a vehicle's motions: invariants, closed forms, steady motions, bifurcations, contact.

Everything starts from numbers that the core has prepared (`field`): nothing here knows about wheels or motors.
"""

# ---- The parts of an analysis in their order. They need none of its libraries.

GEOMETRY = "geometry"
TITLES = {GEOMETRY: "Geometry", "free": "Free motion", "steady": "Steady motions", "bifurcation": "Bifurcations",
          "traction": "Traction"}
PARTS = tuple(TITLES)
