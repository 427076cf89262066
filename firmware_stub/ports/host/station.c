/* One client of the node's port. */
#define _GNU_SOURCE
#include "station.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

void station_clear(station *it, char rate) {
    it->socket = -1;
    it->is_rig = it->speaks = false;
    it->out_count = 0;
    it->letters = STATION_MOST_LETTERS;
    laconic_slcan_init(&it->slcan, rate);
}

int station_connection(int listening) {
    const int client = accept(listening, NULL, NULL);
    if (client < FD_SETSIZE) return client;
    close(client);
    return -1;
}

void station_accept(station *it, int listening, char rate) {
    const int on = 1;
    const int client = station_connection(listening);
    if (client < 0) return;
    station_clear(it, rate);
    it->socket = client;
    setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
#ifdef TCP_NOTSENT_LOWAT
    const int unsent = STATION_SHARED_ROOM;
    if (it->room < STATION_OUT_SIZE) setsockopt(client, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
#endif
}

void station_earn(station *it, uint32_t now_us) {
    const uint32_t passed_ms = (now_us - it->letters_us) / 1000U;
    it->letters_us += 1000U * passed_ms;
    it->letters += (size_t)passed_ms * STATION_LETTERS_PER_MS;
    if (it->letters > STATION_MOST_LETTERS) it->letters = STATION_MOST_LETTERS;
}

ssize_t station_read(const station *it, char *bytes, size_t size) {
    return recv(it->socket, bytes, size, MSG_DONTWAIT);
}

bool station_has_room(const station *it) { return it->out_count + LACONIC_SLCAN_LINE < it->room; }

static bool put(station *it, const char *text, size_t length) {
    if (it->out_count + length > it->room) station_flush(it);
    if (it->out_count + length > it->room) return false;
    memcpy(it->out + it->out_count, text, length);
    it->out_count += length;
    return true;
}

bool station_write(station *it, const laconic_frame *frame) {
    char line[LACONIC_SLCAN_LINE];
    return put(it, line, laconic_slcan_write(&it->slcan, frame, line));
}

void station_reply(station *it) { put(it, it->slcan.reply, strlen(it->slcan.reply)); }

void station_flush(station *it) {
    if (it->socket < 0 || it->out_count == 0) return;
    const ssize_t count = send(it->socket, it->out, it->out_count, MSG_DONTWAIT);
    if (count <= 0) return;
    it->out_count -= (size_t)count;
    memmove(it->out, it->out + count, it->out_count);
}
