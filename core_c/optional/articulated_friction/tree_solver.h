/* The convex problem of one step of a tree, in coordinates ζ in which the energy of the bodies is ½|ζ|²:
 *
 *     ½|ν − ν*|² + Σ contacts [ ½ J (s − s*)² + motor, axle and grip as in friction_solver.h ] + Σ elements
 *
 * An element is a scalar law on one row: x − target = compliance · q + normal cone of [low, high] with x = row·ν. Dry
 * friction, stops, servos, motors with limits, prescribed rates and scrub are all of this kind. */
#ifndef LACONIC_TREE_SOLVER_H
#define LACONIC_TREE_SOLVER_H

#include "friction_internals.h"
#include "tree_posture.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define TREE_WHEELS LACONIC_MAX_WHEELS
#define TREE_ELEMENTS (4 * LACONIC_MAX_BODIES + LACONIC_MAX_WHEELS)

/* What a pass sees of a contact. */
typedef struct tree_sight {
    real t[2], length, axle, firm;
    bool locked;
} tree_sight;

/* What both kinds of pass give for a contact, for the change of ν in the pass: impulse = impulse + S slip of a standing
 * wheel, S = along axis axisᵀ + across other otherᵀ, and speed = speed + turn·slip. Where axis[1] is 0,
 * S is diagonal. */
typedef struct tree_law {
    real along, across, axis[2], other[2]; /* other is not read where across is 0 */
    real impulse[2], speed, turn[2];
    real slip[2]; /* found: the change of moved */
} tree_law;

typedef struct tree_contact {
    const tree_body *on;
    const laconic_tree_rim *wheel;
    tree_row row[2];               /* along; k across                                    */
    real moved[2];                 /* row·ν: slip if the wheel stood still               */
    real along, cross_row, across; /* row[0]·row[0], row[0]·row[1], row[1]·row[1]        */
    real mobility, inverse_mobility, lateral_mass, row_mass[2];
    real creep; /* slip per impulse of a tyre below its limit; mobility includes it */
    friction_load load;
    real push;              /* inertia · free speed                          */
    real speed, impulse[2]; /* found; on entry the guess of the impulse           */
    tree_sight sight;
    tree_law law;
} tree_contact;

typedef struct tree_element {
    real low, high; /* of q; ∓LACONIC_REAL_MAX: no bound */
    real compliance, target;
    real all, inverse_all; /* mobility of the row + compliance                               */
    real share, stiffness; /* of the law inside: q = share·q + stiffness (x − target)        */
    real q;                /* found; on entry the guess                                      */
    real law_stiffness, law_q;
} tree_element;

/* The elements of one row. */
typedef struct tree_bundle {
    const tree_body *on;
    tree_element *first, *end;
    tree_row row;
    real moved, mobility; /* row·ν; row·row */
} tree_bundle;

typedef struct tree_problem {
    const tree_model *m;
    tree_vector free, nu;
    real scale;   /* twice the energy of the motion without contacts and elements, but with what drives them */
    real stress;  /* largest twice the energy that the guess of one impulse or q would give     */
    real penalty; /* stiffness where something holds, over its mass */
    int32_t contact_count, element_count, bundle_count;
    tree_contact contact[TREE_WHEELS];
    tree_element element[TREE_ELEMENTS];
    tree_bundle bundle[TREE_HINGES + TREE_WHEELS];
} tree_problem;

/* Fills what contacts and elements need besides rows, loads, bounds, targets and guesses, scale and stress. */
void laconic_tree_prepare_problem(tree_problem *p);

/* Finds nu, speeds, impulses and q. Returns the number of passes; 0: refused, as friction_solver.h states. */
int32_t laconic_tree_solve(tree_problem *p);

/* Sets S of a law. */
void laconic_tree_split(tree_law *law, real xx, real xy, real yy);

/* Adds the laws to the equations, solves them, and moves ν and all that moves with it. Elements get their q. */
void laconic_tree_move(tree_problem *p);

/* What impulses and q leave of the bodies' equations. */
void laconic_tree_imbalance(tree_vector *rest, const tree_problem *p);

/* Subtracts what impulses and q do. */
void laconic_tree_take_forces(tree_vector *from, const tree_problem *p);

/* Finds anew what moves with ν. */
void laconic_tree_look(tree_problem *p);

/* Sets all speeds to which impulses and q lead. */
void laconic_tree_follow(tree_problem *p);

/* Where the search is on the central path of the smoothed problem. */
typedef friction_path tree_path;

void laconic_tree_start_path(tree_problem *p, tree_path *path);
void laconic_tree_follow_path(tree_problem *p, tree_path *path);

static inline real tree_boxed(real x, real low, real high) { return x > high ? high : (x < low ? low : x); }
static inline bool tree_unbounded(const tree_element *e) {
    return e->high >= LACONIC_REAL_MAX && e->low <= -LACONIC_REAL_MAX;
}
static inline bool tree_one_sided(const tree_element *e) {
    return e->high >= LACONIC_REAL_MAX || e->low <= -LACONIC_REAL_MAX;
}

/* ------------------------------------------------------------------------------- exact passes -- */

/* Looks at all contacts and elements. Returns the square of their residual. */
real laconic_tree_see(tree_problem *p);

/* Replaces each by its law as it was seen, and moves to the solution of these. */
void laconic_tree_exact_pass(tree_problem *p);

/* Sets the laws of elements inside their bounds; `of_mass`: the penalty, over the mass that they hold. */
void laconic_tree_stiffen(tree_problem *p, real of_mass);

#endif
#endif
