/* An estimate that goes on after another step or another vehicle: its error in the coordinates of the new model. */
#include "estimate_parts.h"

/* An error of ζ as the same of the body's origin, whose motion stays, has it in another model (laconic_state_carry). */
static vector in_model(const laconic_model *from, const laconic_model *to, vector zeta) {
    const real yaw_rate = dot(vec(from->yaw_rate_of_zeta), zeta);
    const real ahead = dot(vec(from->velocity_of_zeta[0]), zeta) - yaw_rate * (to->com_y_m - from->com_y_m);
    const real aside = dot(vec(from->velocity_of_zeta[1]), zeta) + yaw_rate * (to->com_x_m - from->com_x_m);
    const real nu[3] = {ahead / to->wheel_radius_m, aside / to->wheel_radius_m, to->yaw_scale * yaw_rate};
    return zeta_of_nu(to, nu);
}

/* Sizes of each component. */
static vector sizes_in_model(const laconic_model *from, const laconic_model *to, vector sizes) {
    const vector x = in_model(from, to, vector_of(sizes.x, R(0), R(0)));
    const vector y = in_model(from, to, vector_of(R(0), sizes.y, R(0)));
    const vector z = in_model(from, to, vector_of(R(0), R(0), sizes.z));
    return vector_of(magnitude(x.x) + magnitude(y.x) + magnitude(z.x), magnitude(x.y) + magnitude(y.y) + magnitude(z.y),
                     magnitude(x.z) + magnitude(y.z) + magnitude(z.z));
}

/* The place is that of S, which a change may shift in the body: an error of the heading turns the shift. */
static state_error error_in_model(const state_error *error, const laconic_plant *before, const laconic_plant *plant) {
    const laconic_model *from = &before->model, *to = &plant->model;
    const real dx = to->com_x_m - from->com_x_m, dy = to->com_y_m - from->com_y_m;
    const real yaw = dot(vec(from->yaw_rate_of_zeta), error->travel), third = R(1) / laconic_root(R(3));
    const direction heading = laconic_direction_of_binary_angle(plant->state.heading.fraction);
    const vector every = vector_of(third, third, third); /* of length 1 */
    state_error carried = *error;
    carried.zeta = in_model(from, to, error->zeta);
    carried.travel = in_model(from, to, error->travel);
    carried.place_m[0] -= yaw * (heading.sine * dx + heading.cosine * dy);
    carried.place_m[1] += yaw * (heading.cosine * dx - heading.sine * dy);
    carried.floor_zeta = size(sizes_in_model(from, to, scaled(error->floor_zeta, every)));
    carried.floor_travel = size(sizes_in_model(from, to, scaled(error->floor_travel, every)));
    carried.doubt_zeta = sizes_in_model(from, to, error->doubt_zeta);
    carried.doubt_travel = sizes_in_model(from, to, error->doubt_travel);
    return carried;
}

/* The twin of a plant with friction, as the change leaves it. */
static laconic_status carry_twin(laconic_estimate *fresh, const laconic_estimate *estimate, const laconic_plant *before,
                                 const laconic_plant *plant, laconic_refusal *why) {
    fresh->twin = estimate->twin;
#if LACONIC_WITH_FRICTION
    fresh->twin_slip = estimate->twin_slip;
#endif
    const laconic_status status = laconic_state_carry(&fresh->twin, &before->model, &plant->model);
    return status == LACONIC_OK ? status : refuse(why, status, LACONIC_FIELD_NONE, 0, R(0), R(0));
}

laconic_status laconic_estimate_carry(laconic_estimate *estimate, const laconic_plant *before,
                                      const laconic_plant *plant, const laconic_method *finer, laconic_refusal *why) {
    laconic_estimate fresh;
    laconic_status status = laconic_estimate_start(&fresh, plant, estimate->most_steps, finer, why);
    if (status == LACONIC_OK && has_friction(before) && has_friction(plant))
        status = carry_twin(&fresh, estimate, before, plant, why);
    if (status != LACONIC_OK) return status;
    if (!has_friction(before) && !has_friction(plant)) {
        const state_error there = laconic_estimate_error_now(estimate, before),
                          error = error_in_model(&there, before, plant);
        laconic_estimate_keep_error(&fresh, &error);
    }
    if (has_friction(before) == has_friction(plant)) {
        laconic_errors until;
        laconic_estimate_read(&until, estimate, before);
        fresh.largest = until.largest;
        fresh.unknown = until.unknown;
        fresh.extent_m = laconic_estimate_extent(estimate, &before->state);
        fresh.origin_m[0] = estimate->origin_m[0];
        fresh.origin_m[1] = estimate->origin_m[1];
    }
    *estimate = fresh;
    return LACONIC_OK;
}
