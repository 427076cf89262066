/* Forces that are fixed in the world: one on a point of body 0, and the slope's pull at each body's centre of mass. */
#include "articulated_visit.h"

#if LACONIC_MAX_BODIES > 0

/* A vector of the world in axes of the given heading. */
static vector seen(direction heading, real x, real y) {
    return vector_of(heading.cosine * x + heading.sine * y, heading.cosine * y - heading.sine * x, R(0));
}

static direction composed(direction a, direction b) {
    return direction_with(a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine);
}

/* m g at s: a wrench about the body's origin. */
static vector weight(vector first_moment, vector pull) {
    return vector_of(first_moment.z * pull.x, first_moment.z * pull.y,
                     first_moment.x * pull.y - first_moment.y * pull.x);
}

void laconic_articulated_add_world(articulated_sweep *s, const laconic_articulated_model *m,
                                   const articulated_drive *drive, direction heading) {
    const vector still = {R(0), R(0), m->mass_kg};
    const vector f = seen(heading, drive->world_force[0], drive->world_force[1]);
    const vector g = m->slope_acceleration;
    direction facing[BODIES];
    s->force[0].x += f.x;
    s->force[0].y += f.y;
    s->force[0].z += drive->world_force_point[0] * f.y - drive->world_force_point[1] * f.x;
    if (g.x == R(0) && g.y == R(0)) return;
    s->force[0] = plus(s->force[0], weight(still, seen(heading, g.x, g.y)));
    facing[0] = heading;
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        facing[b] = composed(facing[link->parent], s->toward[b - 1]);
        s->force[b] = plus(s->force[b], weight(link->first_moment, seen(facing[b], g.x, g.y)));
    }
}

int32_t laconic_articulated_sweep_rotating(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                                           const articulated_drive *drive, direction heading) {
    const int32_t unknown = sweep_outward(s, m, eta, drive);
    if (unknown != 0) return unknown;
    sweep_loads(s, m, drive);
    laconic_articulated_add_world(s, m, drive, heading);
    sweep_inward(s, m);
    return 0;
}

#endif
