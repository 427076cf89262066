"""Properties of a vehicle's motions: invariants, closed forms, steady motions, bifurcations, contact.

Everything starts from numbers that the core has prepared (`field`): nothing here knows about wheels or motors.
"""
