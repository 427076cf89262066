/* A Jacobian's columns as the matrices of a linear model. */
#include "step_change.h"

static void set_column(real *matrix, int32_t columns, int32_t column, const laconic_state_change *from,
                       int32_t wheels) {
    real *at = matrix + column;
    const real head[6] = {from->nu_rad_per_s[0], from->nu_rad_per_s[1], from->nu_rad_per_s[2], from->x_m, from->y_m,
                          from->heading_rad};
    for (int32_t i = 0; i < 6; i++) at[i * columns] = head[i];
    for (int32_t i = 0; i < wheels; i++) at[(6 + i) * columns] = from->wheel_angle_rad[i];
}

static void set_zero(real *matrix, int32_t count) {
    for (int32_t i = 0; i < count; i++) matrix[i] = R(0);
}

void laconic_jacobian_by_state(laconic_real *matrix, const laconic_step_jacobian *jacobian,
                               const laconic_model *model) {
    const int32_t wheels = LACONIC_WHEELS(model), size = 6 + wheels;
    set_zero(matrix, size * size);
    for (int32_t i = 3; i < size; i++) matrix[i * size + i] = R(1);
    for (int32_t i = 0; i < 3; i++) set_column(matrix, size, i, &jacobian->by_nu[i], wheels);
    set_column(matrix, size, 5, &jacobian->by_heading, wheels);
}

void laconic_jacobian_by_input(laconic_real *matrix, const laconic_step_jacobian *jacobian,
                               const laconic_model *model) {
    const int32_t wheels = LACONIC_WHEELS(model), columns = LACONIC_INPUT_NUMBERS(wheels), forces = 2 * wheels;
    set_zero(matrix, (6 + wheels) * columns);
    for (int32_t i = 0; i < wheels; i++) {
        set_column(matrix, columns, i, &jacobian->by_voltage[i], wheels);
        set_column(matrix, columns, wheels + i, &jacobian->by_axle_torque[i], wheels);
    }
    set_column(matrix, columns, forces + 2, &jacobian->by_body_moment, wheels);
    for (int32_t k = 0; k < 2; k++) {
        set_column(matrix, columns, forces + k, &jacobian->by_body_force[k], wheels);
        if (!jacobian->has_world_force) continue;
        set_column(matrix, columns, forces + 3 + k, &jacobian->by_world_force[k], wheels);
        set_column(matrix, columns, forces + 5 + k, &jacobian->by_world_force_point[k], wheels);
    }
}
