/* Stands in for ArduPilot's SITL at the other end of its JSON interface; written from the protocol, to which ArduPilot's
 * libraries/SITL/examples/JSON/readme.md is the guide.
 *
 *     stand_in PORT RATE FRAMES EVERY RESENT < schedule
 *
 * The schedule has lines "frame pulse pulse pulse pulse": pulses of SERVO1 to 4 from that frame on. In lockstep: one
 * packet, then its answer. Each EVERY frames it prints time, north, east, yaw, velocity north and east, yaw rate and the
 * specific force. Each RESENT frames (0: never) it sends the packet again, as if no answer had come, and the answer must
 * be the same. Ends with 1 where an answer is missing or is not as it should be. */
#include <arpa/inet.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>

enum { CHANNELS = 16, SCHEDULED = 4, SECONDS = 5 };

typedef struct {
    uint16_t magic, frame_rate;
    uint32_t frame_count;
    uint16_t pwm[CHANNELS];
} servo_packet;

typedef struct {
    double time_s, gyro[3], force[3], position[3], attitude[3], velocity[3];
} state;

static void fail(const char *text, const char *more) {
    fprintf(stderr, "%s: %.200s\n", text, more);
    exit(1);
}

/* Returns where the value of a key begins, found as ArduPilot finds it: by a search for its letters in the text. */
static const char *value_of(const char *json, const char *section, const char *key) {
    const char *at = strstr(json, section);
    if (!at) fail("no section", section);
    at = strstr(at + strlen(section) + 1, key);
    if (!at) fail("no key", key);
    return at + strlen(key) + 2; /* the quotation mark and the colon */
}

static void read_vector(double to[3], const char *json, const char *section, const char *key) {
    const char *at = value_of(json, section, key);
    if (sscanf(at, "[%lf, %lf, %lf]", &to[0], &to[1], &to[2]) != 3) fail("no vector", at);
}

static state read_state(const char *json) {
    state found;
    found.time_s = atof(value_of(json, "", "timestamp"));
    read_vector(found.gyro, json, "imu", "gyro");
    read_vector(found.force, json, "imu", "accel_body");
    read_vector(found.position, json, "", "position");
    read_vector(found.attitude, json, "", "attitude");
    read_vector(found.velocity, json, "", "velocity");
    return found;
}

/* Sends a packet and returns the length of its answer, one line between two line feeds. */
static size_t exchange(int to, const servo_packet *packet, char *answer, size_t room) {
    if (send(to, packet, sizeof *packet, 0) != (ssize_t)sizeof *packet) fail("not sent", "");
    const ssize_t length = recv(to, answer, room - 1, 0);
    if (length <= 2) fail("no answer", "");
    answer[length] = 0;
    if (answer[0] != '\n' || answer[length - 1] != '\n' || strchr(answer + 1, '\n') != answer + length - 1)
        fail("not one line", answer);
    return (size_t)length;
}

static int connected(uint16_t port) {
    const struct timeval patience = {SECONDS, 0};
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
    const int made = socket(AF_INET, SOCK_DGRAM, 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    setsockopt(made, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (made < 0 || connect(made, (struct sockaddr *)&address, sizeof address)) fail("no socket", "");
    return made;
}

/* Takes the pulses that are due at this frame; `next` is the first line that is not. */
static void schedule(servo_packet *packet, unsigned next[1 + SCHEDULED], int *left) {
    while (*left && next[0] <= packet->frame_count) {
        for (int i = 0; i < SCHEDULED; ++i) packet->pwm[i] = (uint16_t)next[1 + i];
        *left = scanf("%u %u %u %u %u", &next[0], &next[1], &next[2], &next[3], &next[4]) == 1 + SCHEDULED;
    }
}

static void show(const state *now) {
    printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", now->time_s, now->position[0], now->position[1],
           now->attitude[2], now->velocity[0], now->velocity[1], now->gyro[2], now->force[0], now->force[1]);
}

int main(int count, char **words) {
    if (count != 6) fail("usage", "stand_in PORT RATE FRAMES EVERY RESENT < schedule");
    const int to = connected((uint16_t)atoi(words[1])), rate = atoi(words[2]), frames = atoi(words[3]);
    const int every = atoi(words[4]), resent = atoi(words[5]);
    servo_packet packet = {.magic = 18458, .frame_rate = (uint16_t)rate};
    static char answer[65000], again[65000];
    unsigned next[1 + SCHEDULED] = {0, 1500, 1500, 1500, 1500};
    int left = 1;
    for (int frame = 0; frame < frames; ++frame) {
        packet.frame_count = (uint32_t)frame;
        schedule(&packet, next, &left);
        exchange(to, &packet, answer, sizeof answer);
        if (resent && frame % resent == 0) {
            exchange(to, &packet, again, sizeof again);
            if (strcmp(answer, again)) fail("a frame that was sent again has another answer", again);
        }
        const state now = read_state(answer);
        if (fabs(now.time_s - (frame + 1.0) / rate) > 1e-9) fail("not one frame later", answer);
        if ((frame + 1) % every == 0) show(&now);
    }
    return 0;
}
