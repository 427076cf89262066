/* Bits of a frame by ISO 11898-1. */
#include "frame_time.h"

enum {
    STANDARD = 47, /* start 1, identifier 11, RTR, IDE, r0, length 4, CRC 15, delimiter, acknowledge 2, end 7, gap 3 */
    EXTENDED_MORE =
        20, /* SRR, IDE, 18 bits of identifier                                                               */
    FD_ARBITRATION =
        17, /* start 1, identifier 11, RRS, IDE, FDF, res, BRS                                               */
    FD_EXTENDED_MORE = 19,
    FD_END = 13,       /* delimiter, acknowledge 2, end 7, gap 3                    */
    FD_HEAD = 5,       /* ESI, length 4                                             */
    FD_CRC_SHORT = 27, /* up to 16 bytes: stuff count 4, CRC 17, fixed stuff bits 6 */
    FD_CRC_LONG = 32,  /* stuff count 4, CRC 21, fixed stuff bits 7                 */
    LARGEST_WITH_SHORT = 16
};

double frame_time_s(const laconic_frame *frame, uint32_t bit_rate_bit_per_s, uint32_t fd_bit_rate_bit_per_s) {
    const int data = 8 * frame->length;
    const double rate = (double)bit_rate_bit_per_s;
    if (!frame->fd) {
        const int bits = STANDARD + (frame->extended ? EXTENDED_MORE : 0) + (frame->remote ? 0 : data);
        return (double)bits / rate;
    }
    const int slow = FD_ARBITRATION + (frame->extended ? FD_EXTENDED_MORE : 0) + FD_END;
    const int fast = FD_HEAD + data + (frame->length <= LARGEST_WITH_SHORT ? FD_CRC_SHORT : FD_CRC_LONG);
    return (double)slow / rate + (double)fast / (frame->bit_rate_switch ? (double)fd_bit_rate_bit_per_s : rate);
}
