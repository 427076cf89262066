/* Receives a vehicle, its start and its run, number by number, apart from the one that is in use. */
#ifndef LACONIC_NODE_LOADER_H
#define LACONIC_NODE_LOADER_H

#include "laconic/laconic.h"

typedef struct laconic_parameters {
    laconic_vehicle vehicle;
    laconic_start start;
    laconic_real step_s;
    int32_t method;
} laconic_parameters;

/* How many fields it takes. */
#define LACONIC_LOADER_ONE(of, number, ...) +1
#define LACONIC_LOADER_FIELDS (0 LACONIC_PARAMETER_FIELDS(LACONIC_LOADER_ONE))

typedef struct laconic_loader {
    laconic_parameters parameters;
    uint32_t checksum; /* CRC-32 so far                                                  */
    uint16_t frame_count;
    uint8_t status;                /* LACONIC_WIRE_STATUS_… of the first frame that was no use; 0    */
    uint8_t field, item;           /* … and what it was about                                        */
    uint8_t half_field, half_item; /* lower half of a double waits for its upper half; 0: none */
    uint32_t half;
    uint32_t given[LACONIC_LOADER_FIELDS]; /* bit = item, 0 where the field has none                   */
} laconic_loader;

void laconic_loader_begin(laconic_loader *loader);

/* Takes one PARAMETER frame (8 bytes, protection already checked). */
void laconic_loader_take(laconic_loader *loader, const uint8_t data[8]);

/* 0 iff every frame was of use, none is missing, the checksum is right, and nothing is left out that a scene file must
 * give; else LACONIC_WIRE_STATUS_… and what it is about. Whether the vehicle is any good is for the core to say. */
uint8_t laconic_loader_check(const laconic_loader *loader, uint16_t frame_count, uint32_t checksum, uint8_t *field,
                             uint8_t *item);

#endif
