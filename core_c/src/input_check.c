/* Which number of an input is not finite? Steps notice that one is; this finds it for the message. */
#include "internal.h"

static laconic_status check_many(const real *numbers, int32_t count, laconic_field field, laconic_refusal *why) {
    int32_t i;
    for (i = 0; i < count; i++)
        if (!is_finite(numbers[i])) return refuse(why, LACONIC_NOT_FINITE, field, i + 1, numbers[i], R(0));
    return LACONIC_OK;
}

laconic_status laconic_input_check(const laconic_model *model, const laconic_input *input, laconic_refusal *why) {
    const int32_t n = model->wheel_count;
    laconic_status status = check_many(input->voltage_V, n, LACONIC_FIELD_VOLTAGE, why);
    if (status == LACONIC_OK) status = check_many(input->axle_torque_Nm, n, LACONIC_FIELD_AXLE_TORQUE, why);
    if (status == LACONIC_OK) status = check_many(input->body_force_N, 2, LACONIC_FIELD_BODY_FORCE, why);
    if (status == LACONIC_OK && !is_finite(input->body_moment_Nm))
        status = refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0, input->body_moment_Nm, R(0));
    if (status == LACONIC_OK) status = check_many(input->world_force_N, 2, LACONIC_FIELD_WORLD_FORCE, why);
    if (status == LACONIC_OK) status = check_many(input->world_force_point_m, 2, LACONIC_FIELD_WORLD_FORCE_POINT, why);
    return status;
}
