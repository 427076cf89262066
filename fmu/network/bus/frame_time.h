/* How long a frame occupies a CAN bus. */
#ifndef LACONIC_FMU_NETWORK_BUS_FRAME_TIME_H
#define LACONIC_FMU_NETWORK_BUS_FRAME_TIME_H

#include <stdint.h>

#include "laconic_node/frame.h"

/* Seconds from the start bit to the end of the three bits of intermission, without dynamic stuff bits. The data of a
 * CAN FD frame with bit rate switch are at fd_bit_rate. Rates above 0. */
double frame_time_s(const laconic_frame *frame, uint32_t bit_rate_bit_per_s, uint32_t fd_bit_rate_bit_per_s);

#endif
