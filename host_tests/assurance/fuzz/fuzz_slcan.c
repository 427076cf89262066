/* Any bytes on the serial line: the reader stays within its buffers, and a frame that is written reads back the
 * same. */
#include "laconic_node/slcan.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(bool holds) {
    if (!holds) abort();
}

static void read_back(const laconic_frame *frame) {
    laconic_slcan writer;
    laconic_frame again;
    char line[LACONIC_SLCAN_LINE];
    laconic_slcan_init(&writer, 0);
    writer.open = true;
    const size_t length = laconic_slcan_write(&writer, frame, line);
    laconic_slcan_event event = LACONIC_SLCAN_NOTHING;
    for (size_t k = 0; k < length; k++) event = laconic_slcan_feed(&writer, line[k], &again);
    must(event == LACONIC_SLCAN_FRAME && again.id == frame->id && again.length == frame->length);
    must(frame->remote || memcmp(again.data, frame->data, frame->length) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    laconic_slcan slcan;
    laconic_frame frame;
    laconic_slcan_init(&slcan, size > 0 && data[0] & 1U ? '6' : 0);
    for (size_t k = 0; k < size; k++) {
        switch (laconic_slcan_feed(&slcan, (char)data[k], &frame)) {
        case LACONIC_SLCAN_FRAME:
            must(slcan.open && !slcan.listen_only && frame.length <= LACONIC_FRAME_BYTES);
            read_back(&frame);
            break;
        case LACONIC_SLCAN_REPLY: must(strlen(slcan.reply) < sizeof slcan.reply); break;
        default: break;
        }
    }
    return 0;
}
