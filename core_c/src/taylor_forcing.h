/* b as a series: parabolas through the samples, and the heading that turns a force fixed in the world. */
#ifndef LACONIC_TAYLOR_FORCING_H
#define LACONIC_TAYLOR_FORCING_H

#include "load.h"
#include "taylor.h"

typedef struct forcing {
    vector constant[3], cosine[3], sine[3];
    real heading_cosine[ORDER], heading_sine[ORDER];
    bool turns;
} forcing;

static void parabola(vector term[3], const real start[3], const real middle[3], const real end[3]) {
    const vector half = minus(vec(middle), vec(start)), whole = minus(vec(end), vec(start));
    term[0] = vec(start);
    term[1] = minus(scaled(R(4), half), whole);
    term[2] = scaled(R(2), minus(whole, scaled(R(2), half)));
}

static forcing forcing_of(const laconic_loads *loads, const laconic_heading *heading) {
    static const laconic_load still = {{R(0), R(0), R(0)}, {R(0), R(0), R(0)}, {R(0), R(0), R(0)}, false};
    const laconic_load *at[3] = {loads->start, loads->middle, loads->end};
    forcing f;
    direction now;
    int k;
    parabola(f.constant, at[0]->constant, at[1]->constant, at[2]->constant);
    f.turns = LACONIC_WITH_WORLD_FORCE && (at[0]->turns || at[1]->turns || at[2]->turns);
    if (!f.turns) return f; /* the rest is not looked at */
    for (k = 0; k < 3; k++)
        if (!at[k]->turns) at[k] = &still;
    parabola(f.cosine, at[0]->cosine, at[1]->cosine, at[2]->cosine);
    parabola(f.sine, at[0]->sine, at[1]->sine, at[2]->sine);
    now = laconic_direction_of_turn(heading->fraction);
    f.heading_cosine[0] = now.cosine;
    f.heading_sine[0] = now.sine;
    return f;
}

/* (cos θ)' = −θ' sin θ, (sin θ)' = θ' cos θ, coefficient by coefficient. */
static void turn_on(forcing *f, const course *c, real turn, int n) {
    real cosine = R(0), sine = R(0);
    int j;
    for (j = 0; j < n; j++) {
        cosine -= c->yaw[j] * f->heading_sine[n - 1 - j];
        sine += c->yaw[j] * f->heading_cosine[n - 1 - j];
    }
    f->heading_cosine[n] = turn * inverse[n - 1] * cosine;
    f->heading_sine[n] = turn * inverse[n - 1] * sine;
}

/* b0: what acts before anything has moved. */
static vector first_forcing(const forcing *f) {
    const vector b = f->constant[0];
    if (!f->turns) return b;
    return plus(b, plus(scaled(f->heading_cosine[0], f->cosine[0]), scaled(f->heading_sine[0], f->sine[0])));
}

/* bn for n >= 1, from the coefficients of the motion below n. */
static vector forcing_term(forcing *f, const course *c, real turn, int n) {
    vector b = n < 3 ? f->constant[n] : none;
    int k;
    if (!f->turns) return b;
    turn_on(f, c, turn, n);
    for (k = 0; k < 3 && k <= n; k++)
        b = plus(b, plus(scaled(f->heading_cosine[n - k], f->cosine[k]), scaled(f->heading_sine[n - k], f->sine[k])));
    return b;
}

#endif
