/* A CAN node that simulates the vehicle. It accesses neither clock nor bus: a port passes frames and the time to it and
 * fetches the frames that it sends.
 *
 *     for (;;) {
 *         while (receive(&frame)) laconic_node_on_frame(&node, &frame, now());
 *         laconic_node_on_tick(&node, now());
 *         while (laconic_node_next_frame(&node, &frame)) send(&frame);
 *     }
 *
 * No heap, no blocking, no queue: a frame is made from the newest state when it is fetched, so none is ever stale. A
 * call handles one frame, or at most LACONIC_NODE_STEPS_PER_TICK steps.
 *
 * Time is a count of microseconds that may wrap: only differences are used, and on_tick must be called at least
 * every half hour. laconic.dbc defines the frames.
 *
 * START_DRIVES puts motor drives between the bus and the wheels: the node then takes one step a period, every frame
 * that is not for its identifiers goes to the chosen protocol of drives (protocol.h), and that protocol's frames are
 * fetched among the node's own. So a controller that speaks that protocol drives the vehicle, and a rig that shares
 * its bus goes on reading the node's frames. */
#ifndef LACONIC_NODE_H
#define LACONIC_NODE_H

#include "laconic_drives/drives.h"
#include "laconic_node/counters.h"
#include "laconic_node/frame.h"
#include "laconic_node/loader.h"
#include "laconic_node/raw_frames.h"
#include "laconic_node/session.h"
#include "laconic_wire.h"
#if LACONIC_NODE_WITH_ESTIMATE
#include "laconic/estimate.h"
#endif
#if LACONIC_NODE_WITH_HINGES && (LACONIC_MAX_BODIES < 1 || LACONIC_MAX_BODIES > 9)
#error "laconic: STEERING numbers nine hinges: set LACONIC_MAX_BODIES to 1 to 9, or LACONIC_NODE_WITH_HINGES to 0"
#endif
#if LACONIC_NODE_WITH_HINGES && LACONIC_MAX_WHEELS + LACONIC_MAX_BODIES > 31
#error "laconic: a loader notes 31 items: lower LACONIC_MAX_WHEELS, or set LACONIC_NODE_WITH_HINGES to 0"
#endif

#ifndef LACONIC_NODE_STEPS_PER_TICK
#define LACONIC_NODE_STEPS_PER_TICK 64
#endif
#ifndef LACONIC_NODE_AXIS_BYTES
#define LACONIC_NODE_AXIS_BYTES 1024 /* room for what a protocol keeps of one drive */
#endif
#define LACONIC_NODE_HEARTBEAT_US 100000U
#define LACONIC_NODE_ID_STRIDE 32U /* a node uses 32 identifiers from its base */

typedef struct laconic_node_config {
    uint16_t id_base;                                /* multiple of 32, at most 0x7E0             */
    bool can_fd;                                     /* the bus and the controller can do CAN FD  */
    const laconic_method *(*method)(int32_t number); /* the methods that are linked; as
                                                         laconic_method_by_number                  */
    uint32_t nonce_seed;                             /* different at each power-up, from a hardware
                                                         generator, noise or a boot counter; 0: none         */
#if LACONIC_NODE_WITH_DRIVES
    const laconic_drive_protocol *(*protocol)(int32_t number); /* the protocols of drives that are linked, as
                                                         laconic_drive_protocol_by_number; NULL: none        */
#endif
} laconic_node_config;

typedef struct laconic_node_result {
    uint8_t request, command, status, field, item;
} laconic_node_result;

/* Lockstep: steps that are due, and the request of their SYNC. */
typedef struct laconic_node_lockstep {
    uint32_t steps_due;
    uint8_t request;
} laconic_node_lockstep;

typedef struct laconic_node_free_run {
    uint32_t rate_Hz, watchdog_us; /* watchdog 0: none                                             */
    uint32_t steps_per_period;
    uint32_t next_us, next_rest; /* when the next period begins: next_us + next_rest/rate        */
    uint32_t fed_us;             /* when the voltages of all wheels had last come                */
    uint32_t worst_lateness_us;
} laconic_node_free_run;

#if LACONIC_NODE_WITH_HINGES
/* A vehicle with hinges moves by these. The plant then holds the numbers of wheels and steps and the step's size alone,
 * which the frames of every vehicle use. */
typedef struct laconic_node_hinges {
    bool here;           /* the vehicle has hinges                                                */
    bool changes;        /* STEERING has come: the next step goes to its numbers                  */
    uint8_t send;        /* chosen frames: LACONIC_NODE_SEND_VELOCITY …                           */
    uint8_t angle_group; /* next HINGE_ANGLE group                                                */
    uint8_t rate_group;  /* next HINGE_RATE group                                                 */
#if LACONIC_NODE_WITH_SLIP
    bool slips; /* on ground with friction: `tree_model` and `tree` move it; of model and integrator it has the
                   counts and the step's size, which the frames of both use */
    laconic_tree_model tree_model;
#endif
    laconic_articulated_model model;
    laconic_articulated_integrator integrator;
    laconic_articulated_state state;
#if LACONIC_NODE_WITH_SLIP
    laconic_tree_state tree;                    /* of a vehicle that slips                                       */
    laconic_real angle_rad[LACONIC_MAX_BODIES]; /* targets of its servos and loops               */
#endif
    laconic_real twist[3];              /* at the end of the last step                           */
    laconic_articulated_start start;    /* RESET returns to it, with `first` …                   */
    laconic_articulated_input first;    /* … commanded                                           */
    laconic_articulated_input input[2]; /* at the start and the end of the next step; their `base`
                                            is that of laconic_node.input                         */
} laconic_node_hinges;

#define LACONIC_NODE_SEND_VELOCITY 1U
#define LACONIC_NODE_SEND_HINGE_ANGLE 2U
#define LACONIC_NODE_SEND_HINGE_RATE 4U
#endif

#if LACONIC_NODE_WITH_XCP
/* A slave of ASAM's XCP 1.1 on CAN: a master of a calibration tool changes numbers of the vehicle and measures outputs
 * while a rig or drives move it. In builds with LACONIC_NODE_WITH_XCP 1; the others contain nothing of it. It uses two
 * of the node's identifiers and needs no call of a port: laconic_node_on_frame takes commands, and
 * laconic_node_next_frame gives answers and samples, behind the node's own frames.
 *
 * Addresses are virtual; nobody reads or writes memory by them. All numbers have four bytes, little-endian: reals are
 * IEEE numbers of single precision, also where the node computes in double, all others 32-bit integers.
 *
 *     0x10000 + 128 · field + 4 · k     PARAMETER.field of laconic.dbc; k counts its items from 0
 *     0x20000 + 128 · bit + 4 · k       output: `bit` is the first bit of its signal in SELECT (raw_nu …; take_voltage:
 *                                       the voltages; send_error_estimate: pages of ERROR_ESTIMATE); bit 0: step count
 *                                       and state, as integers
 *     0x30000                           the identification
 *
 * Calibration: one segment, the fields 0 to 63, with two pages. Page 1, the reference, is the vehicle of COMMIT. Page
 * 0, the working page, begins as its copy. While the node runs on the working page, a number acts at the border of the
 * next step, as soon as its last byte has come: laconic_plant_change() prepares the whole vehicle anew and may refuse.
 * The master then gets an error and the node keeps its numbers; a RESULT to CALIBRATE names status, field and item.
 * While the node runs on the reference, the working page may be inconsistent: SET_CAL_PAGE checks it. Writing a number
 * that is already there changes no bit of it. Counts, and kinds and places of wheels, can be read, but not written;
 * the same holds for all numbers of vehicles with hinges.
 *
 * Measurement: dynamic lists; event 0 is each step, 1 and 2 are the first steps at or behind each 10 and 100 ms. Stamps
 * are step count · step in microseconds: integers, the same in lockstep and free run. In lockstep steps wait for room
 * in the queue, so no sample is lost. Free run and drives do not wait: a sample without room is dropped as a whole and
 * the master gets the event DAQ_OVERLOAD. */
#define LACONIC_XCP_LISTS 8
#define LACONIC_XCP_ODTS 48    /* of all lists: frames of one instant                 */
#define LACONIC_XCP_ENTRIES 96 /* of all lists                                        */
#define LACONIC_XCP_QUEUE 64   /* frames; room for those of an instant, at most 255   */
#define LACONIC_XCP_PARAMETERS 0x10000U
#define LACONIC_XCP_OUTPUTS 0x20000U
#define LACONIC_XCP_TEXTS 0x30000U
#define LACONIC_XCP_EACH 128U       /* bytes of a field or an output                       */
#define LACONIC_XCP_SEGMENT 0x2000U /* bytes of the calibration segment, and of a checksum at most */
#define LACONIC_XCP_TEXT_BYTES 16U
#define LACONIC_XCP_EVENTS 3U /* each step, 10 ms, 100 ms                            */
#define LACONIC_XCP_WORKING_PAGE 0U
#define LACONIC_XCP_REFERENCE_PAGE 1U

typedef struct laconic_xcp_packet {
    uint8_t length, data[8];
} laconic_xcp_packet;

typedef struct laconic_xcp_odt {
    uint8_t first_entry, entries;
} laconic_xcp_odt;

typedef struct laconic_xcp_list {
    uint8_t first_odt, odts, event, prescaler, count;
    bool has_mode, stamped, selected, running;
} laconic_xcp_list;

typedef struct laconic_xcp {
    bool connected, answers; /* `answer` waits to be fetched                                      */
    bool overloaded, ended;  /* events that wait                                                  */
    bool senses;             /* the master has read sensors: they watch every step                */
    uint8_t phase;           /* of the allocation of lists                                        */
    uint8_t node_page, master_page;
    uint8_t list_count, odt_count, entry_count;
    uint8_t at_list, at_odt, at_entry; /* where WRITE_DAQ writes                                  */
    uint8_t first, waiting;            /* of the queue                                            */
    uint8_t seen_bit;                  /* the output that `seen` holds at this moment; 0: none    */
    uint32_t address;                  /* for UPLOAD, DOWNLOAD and BUILD_CHECKSUM                 */
    uint32_t part_address;             /* of the number whose first bytes have come               */
    uint8_t part[4];
    laconic_xcp_packet answer;
    laconic_xcp_list list[LACONIC_XCP_LISTS];
    laconic_xcp_odt odt[LACONIC_XCP_ODTS];
    uint32_t entry[LACONIC_XCP_ENTRIES]; /* address, and the size in the highest byte             */
    laconic_xcp_packet queue[LACONIC_XCP_QUEUE];
    laconic_raw_output seen;
    laconic_vehicle page[2]; /* of the segment; that of the node is also the plant's vehicle      */
} laconic_xcp;
#endif

/* Small members come first: small processors reach them by shorter instructions. */
typedef struct laconic_node {
    uint8_t state; /* LACONIC_WIRE_STATE_…                                     */
    uint8_t send;  /* chosen frames: LACONIC_NODE_SEND_…                       */
    bool raw_fd;
    bool model_is_wrong; /* integrity.c has found it: no order but COMMIT uses it    */
    uint8_t wheel_group; /* next WHEEL_SPEED group                                   */
#if LACONIC_NODE_WITH_SENSORS
    uint8_t angle_group;   /* next WHEEL_ANGLE group                                  */
    uint8_t encoder_wheel; /* of the next ENCODER                                     */
#endif
    uint8_t counter_page;
    uint8_t groups_seen;  /* VOLTAGE groups since the watchdog was fed                */
    uint16_t answers_due; /* RESULTs to be sent: bit = offset of the answered frame    */
    uint32_t pending;     /* frames to be sent: bit = offset of the identifier        */
    uint32_t heartbeat_us;
    laconic_node_free_run free_run;
    laconic_node_lockstep lockstep;
    laconic_node_counters counters;
    laconic_node_session session;
    laconic_node_config config;
    laconic_node_result answer[LACONIC_WIRE_RIG_OFFSETS]; /* the last to each kind, for when its frame is repeated */
    uint8_t sent[LACONIC_WIRE_NODE_OFFSETS];              /* counts of the frames that were sent                   */
    laconic_loader loader;
    laconic_start start; /* RESET returns to it                                      */
    laconic_plant plant;
    laconic_input input[LACONIC_NODE_DRIVES_ONLY ? 1 : 3]; /* held: [0]; sampled: start, middle, end */
    laconic_raw_input raw_input;
    laconic_raw_output raw_output;
#if LACONIC_NODE_WITH_DRIVES
    laconic_drive_plan drive_plan; /* of the vehicle, for START_DRIVES                         */
    laconic_drives drives;
    uint64_t axes[(LACONIC_DRIVE_AXES * LACONIC_NODE_AXIS_BYTES + 7) / 8]; /* of the protocol */
#endif
#if LACONIC_NODE_WITH_SENSORS
    laconic_sensors sensors; /* beside the plant */
    bool has_sensors;        /* the vehicle came with settings of them: they watch every step */
#endif
#if LACONIC_NODE_WITH_ESTIMATE
    bool estimates;        /* SELECT has chosen ERROR_ESTIMATE: `estimate` watches every step */
    uint8_t estimate_page; /* next ERROR_ESTIMATE page                                        */
    laconic_estimate estimate;
    laconic_errors estimated; /* what its pages tell */
#endif
#if LACONIC_NODE_WITH_HINGES
    laconic_node_hinges hinges;
#endif
#if LACONIC_NODE_WITH_XCP
    laconic_xcp xcp;
#endif
} laconic_node;

#define LACONIC_NODE_SEND_NU 1U
#define LACONIC_NODE_SEND_POSE 2U
#define LACONIC_NODE_SEND_WHEEL_SPEED 4U
#define LACONIC_NODE_SEND_WHEEL_ANGLE 8U
#define LACONIC_NODE_SEND_COUNTERS 16U
#define LACONIC_NODE_SEND_STATE_FD 32U
#define LACONIC_NODE_SEND_IMU 64U
#define LACONIC_NODE_SEND_ENCODER 128U
#define LACONIC_NODE_ESTIMATE_PAGES 8U

/* False iff the ID base is not a multiple of 32 or is above 0x7E0, there is no `method`, or `can_fd` is set in a build
 * without CAN FD (LACONIC_NODE_CAN_FD 0), whose frames have room for 8 bytes. The node is then not usable: a port must
 * stop. */
bool laconic_node_init(laconic_node *node, const laconic_node_config *config, uint32_t now_us);

void laconic_node_on_frame(laconic_node *node, const laconic_frame *frame, uint32_t now_us);
void laconic_node_on_tick(laconic_node *node, uint32_t now_us);

/* The next frame to send; false iff there is none. */
bool laconic_node_next_frame(laconic_node *node, laconic_frame *frame);

/* True while on_tick has steps to take: the port should not sleep. Steps of lockstep that wait until samples of XCP
 * have been fetched do not count. */
bool laconic_node_is_busy(const laconic_node *node);

/* Microseconds until on_tick has something to do, at most the time to the next heartbeat; 0: now. */
uint32_t laconic_node_idle_us(const laconic_node *node, uint32_t now_us);

#include "laconic_node/build.h" /* a port with other definitions than the node's does not link */

#endif
