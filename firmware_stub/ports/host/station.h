/* One client of the node's port: its connection, its SLCAN channel, and the bytes that wait for it. */
#ifndef LACONIC_HOST_STATION_H
#define LACONIC_HOST_STATION_H

#include "laconic_node/slcan.h"

#include <sys/types.h>

enum { STATION_OUT_SIZE = 1 << 16 };

typedef struct station {
    int socket;  /* -1: there is no client                                              */
    bool is_rig; /* it gets the node's own frames, not only those of its drives */
    laconic_slcan slcan;
    char out[STATION_OUT_SIZE];
    size_t out_count;
} station;

/* Without client, its channel closed. `rate`: as laconic_slcan_init() takes it. */
void station_clear(station *it, char rate);
/* The connection of a waiting client; -1 where there is none, or its number is beyond what can be waited for. */
int station_connection(int listening);
/* Accepts a waiting client; nothing happens where there is none. */
void station_accept(station *it, int listening, char rate);

/* Reads into `bytes`; the result of recv(). */
ssize_t station_read(const station *it, char *bytes, size_t size);
/* Whether one frame more has room among the bytes that wait. */
bool station_has_room(const station *it);
/* The frame waits to be sent. A client that does not read loses it, as on a full bus. */
void station_write(station *it, const laconic_frame *frame);
/* The answer to a command of SLCAN waits to be sent. */
void station_reply(station *it);
/* Sends what the connection takes now. */
void station_flush(station *it);

#endif
