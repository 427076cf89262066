/* What an IMU feels beside a plant: for sensors.c, and tests. Not for users. */
#ifndef LACONIC_IMU_H
#define LACONIC_IMU_H

#include "common.h"

/* On ideal ground, at this moment with this input. */
void laconic_imu_feel_now(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_plant *plant,
                          const laconic_input *input);
void laconic_accelerate_now(laconic_real acceleration_m_per_s2[2], const laconic_plant *plant,
                            const laconic_input *input);

/* With friction, in the mean over the step that began `before`. */
void laconic_imu_feel_step(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_plant *plant,
                           const laconic_sensor_moment *before);
void laconic_accelerate_over_step(laconic_real acceleration_m_per_s2[2], const laconic_plant *plant,
                                  const laconic_sensor_moment *before);

#endif
