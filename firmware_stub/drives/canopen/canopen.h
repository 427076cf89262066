/* Inside of the CANopen drives: what one node remembers, and the functions that its files call from each other.
 *
 *     canopen.c      frames to nodes, time, the order of sending; NMT and heartbeat
 *     sdo.c          reads and writes objects on request   ┐
 *     pdo.c          sends and receives mapped objects     ┴ object_access.c: the objects themselves (objects.h)
 *     emergency.c    error register and history, EMCY, what a lost connection does
 *     state.c        the CiA 402 state machine: controlword, statusword
 *     motion.c       modes of operation: from target objects to the target of the drive */
#ifndef LACONIC_CANOPEN_H
#define LACONIC_CANOPEN_H

#include "laconic_drives/protocol.h"

enum { CANOPEN_HISTORY = 4, CANOPEN_MAPPED = 4, CANOPEN_PDOS = 4 };

/* The lower half of a row's form: the numbers of CiA 301's data types. The upper half: access. */
enum {
    CANOPEN_I8 = 2,
    CANOPEN_I16 = 3,
    CANOPEN_I32 = 4,
    CANOPEN_U8 = 5,
    CANOPEN_U16 = 6,
    CANOPEN_U32 = 7,
    CANOPEN_STRING = 9,
    CANOPEN_R = 16,
    CANOPEN_W = 32,
    CANOPEN_TX = 64,
    CANOPEN_RX = 128
};
enum { CANOPEN_ARRAY = 8, CANOPEN_RECORD = 9 };

/* SDO abort codes; 0: none. */
#define CANOPEN_TOGGLE 0x05030000U        /* toggle bit not alternated                      */
#define CANOPEN_COMMAND 0x05040001U       /* command specifier unknown or not expected      */
#define CANOPEN_NO_ACCESS 0x06010000U     /* unsupported access                             */
#define CANOPEN_READ_ONLY 0x06010002U     /* write of a read-only object                    */
#define CANOPEN_NO_OBJECT 0x06020000U     /* index unknown                                  */
#define CANOPEN_NOT_MAPPABLE 0x06040041U  /* object cannot be mapped to the PDO             */
#define CANOPEN_PDO_TOO_LONG 0x06040042U  /* mapped objects exceed the PDO                  */
#define CANOPEN_TOO_LONG 0x06070012U      /* more bytes than the object has                 */
#define CANOPEN_TOO_SHORT 0x06070013U     /* fewer                                          */
#define CANOPEN_NO_SUB 0x06090011U        /* sub-index unknown                              */
#define CANOPEN_VALUE 0x06090030U         /* value out of range                             */
#define CANOPEN_TOO_HIGH 0x06090031U      /* value above the object's limit                 */
#define CANOPEN_TOO_LOW 0x06090032U       /* value below it                                 */
#define CANOPEN_PRESENT_STATE 0x08000022U /* not in this state of the device                */
#define CANOPEN_NO_DATA 0x08000024U       /* nothing there to read                          */

/* States of NMT, as heartbeats carry them. */
enum { CANOPEN_BOOT = 0, CANOPEN_STOPPED = 4, CANOPEN_OPERATIONAL = 5, CANOPEN_PRE_OPERATIONAL = 127 };

/* States of CiA 402, rising with what the drive may do; state.c has the statusword of each. */
typedef enum canopen_state {
    CANOPEN_DISABLED = 0, /* switch on disabled */
    CANOPEN_READY,
    CANOPEN_SWITCHED_ON,
    CANOPEN_ENABLED,
    CANOPEN_QUICK_STOP,
    CANOPEN_FAULT_REACTION,
    CANOPEN_FAULT
} canopen_state;

/* Modes of operation, and the bits of 0x6502 that say which there are. */
enum {
    CANOPEN_PROFILE_POSITION = 1,
    CANOPEN_PROFILE_VELOCITY = 3,
    CANOPEN_CYCLIC_POSITION = 8,
    CANOPEN_CYCLIC_VELOCITY = 9,
    CANOPEN_CYCLIC_TORQUE = 10,
    CANOPEN_MODES = 1 | 1 << 2 | 1 << 7 | 1 << 8 | 1 << 9
};

/* Bits of the controlword. */
enum {
    CANOPEN_NEW_SET_POINT = 16,
    CANOPEN_AT_ONCE = 32,
    CANOPEN_RELATIVE = 64,
    CANOPEN_RESET = 128,
    CANOPEN_HALT = 256
};

/* Frames that a node has to send: bits of `due`, in the order of their usual identifiers. */
enum {
    CANOPEN_DUE_BOOT = 1,
    CANOPEN_DUE_EMERGENCY = 2,
    CANOPEN_DUE_TPDO = 4, /* and 8, 16, 32 */
    CANOPEN_DUE_SDO = 64,
    CANOPEN_DUE_HEARTBEAT = 128
};

/* Upper bits of a stored COB-ID. */
enum { CANOPEN_OFF = 0x8000, CANOPEN_NO_REMOTE = 0x4000 };

/* Small members come first: small processors reach them by shorter instructions. */
typedef struct canopen_pdo {
    uint8_t type, count;
    uint8_t row[CANOPEN_MAPPED]; /* of the dictionary; 0xFF: empty */
    uint8_t data[8];             /* received and waiting for SYNC; last sent */
    uint16_t cob_id;
    uint16_t timer_ms, inhibit_100us;
    uint32_t at_us; /* last received; last sent or due */
} canopen_pdo;

typedef struct canopen_axis {
    /* communication */
    uint8_t nmt, behaviour, error_register;
    uint8_t history_count, emergencies; /* emergencies: newest of the history that are still to be sent */
    uint8_t due;
    uint8_t received; /* bits: RPDOs with data that waits for SYNC; from 16 on: those with a deadline */
    uint8_t trouble;  /* bits: CANOPEN_TROUBLE_…, CANOPEN_LISTENS, CANOPEN_FOLLOWS_BADLY */
    uint8_t sdo_sub, sdo_row, sdo_at, sdo_step;
    /* the drive */
    uint8_t state, ending, ramp; /* ending: state after the ramp to standstill; CANOPEN_NO_ENDING: no ramp */
    uint8_t set_point;           /* bits: CANOPEN_SET_POINT_… */
    int8_t mode, mode_display;
    uint8_t period;
    int8_t period_exponent;
    uint16_t controlword, error_code;
    int16_t connection_option, quick_stop_option, shutdown_option, disable_option, halt_option, fault_option;
    int16_t target_torque, torque_offset;
    uint16_t max_torque, following_ms, speed_window, speed_threshold;
    uint16_t producer_ms, sync_id, emergency_id, sdo_index;
    uint32_t consumer, consumer_us, producer_us; /* consumer: as 0x1016 has it */
    uint32_t following_window, following_us, position_window;
    int32_t target_position, target_speed, speed_offset;
    int32_t goal, next_goal; /* of profile position */
    uint32_t max_speed, profile_speed, acceleration, deceleration, quick_deceleration;
    laconic_real rated_A; /* of the drive's settings; 0x6072 limits what is used of it */
    laconic_real speed;   /* demand, counts/s */
    laconic_real left_s;  /* until the interpolation reaches 0x607A */
    laconic_real demand_rest;
    int64_t demand; /* position, counts; not wrapped */
    uint8_t sdo_answer[8];
    uint8_t sdo_data[4];               /* of a segmented transfer */
    uint8_t syncs[CANOPEN_PDOS];       /* since each TPDO was sent */
    uint16_t history[CANOPEN_HISTORY]; /* newest first */
    canopen_pdo pdo[2 * CANOPEN_PDOS]; /* received, then sent */
} canopen_axis;

enum { CANOPEN_NO_ENDING = 0xFF };
/* Bits of `trouble`; those of CANOPEN_TROUBLE are errors of the communication that remain. */
enum {
    CANOPEN_TROUBLE_LENGTH = 1,
    CANOPEN_TROUBLE_SILENCE = 2, /* no heartbeat comes */
    CANOPEN_LISTENS = 4,
    CANOPEN_FOLLOWS_BADLY = 8,
    CANOPEN_TROUBLE_DEADLINE = 16, /* and 32, 64, 128: that RPDO does not come */
    CANOPEN_TROUBLE = 0xF3
};
enum {
    CANOPEN_SET_POINT_MOVES = 1,
    CANOPEN_SET_POINT_WAITS = 2,
    CANOPEN_SET_POINT_HELD = 4,
    CANOPEN_TARGET_IS_NEW = 8
};

/* One node while a frame or a step is handled. */
typedef struct canopen_node {
    canopen_axis *axis;
    laconic_wheel_drive *drive;
    laconic_real step_s;
    uint32_t now_us;
    laconic_real watchdog_s; /* of the scene: the deadline of RPDO 2 to 4 after a reset; 0: none */
} canopen_node;

/* Six bytes, since there are nearly a hundred of them. */
typedef struct canopen_row {
    uint16_t index;
    uint8_t subs; /* the first and, times 16, the last sub-index */
    uint8_t form;
    uint16_t from; /* CANOPEN_FROM_…, with the offset in canopen_axis, the value or the canopen_call */
} canopen_row;
enum { CANOPEN_FROM_AXIS = 0, CANOPEN_FROM_ROW = 0x4000, CANOPEN_FROM_CALL = 0x8000, CANOPEN_FROM = 0xC000 };

static inline uint8_t canopen_sub(const canopen_row *row) { return row->subs & 15U; }
static inline bool canopen_is_from_axis(const canopen_row *row) { return (row->from & CANOPEN_FROM) == 0; }

static inline uint8_t canopen_id(const canopen_node *on) { return (uint8_t)on->drive->settings.node_id; }

/* object_access.c */
#define CANOPEN_NO_ROW 0xFFU
const canopen_row *canopen_row_at(uint8_t number);
/* Number of the row of an object; CANOPEN_NO_ROW, and why. */
uint8_t canopen_find(uint16_t index, uint8_t sub, uint32_t *abort);
uint8_t canopen_size(const canopen_row *row); /* bytes; 0: a string */
const char *canopen_text(uint16_t index);     /* of a string */
/* Values as unsigned numbers of 32 bits, the lower bytes of which are the object. Index and sub may differ from those
 * of the row, which can stand for several. Each gives an abort code, 0 iff done. */
uint32_t canopen_read(const canopen_node *on, const canopen_row *row, uint16_t index, uint8_t sub, uint32_t *value);
uint32_t canopen_write(const canopen_node *on, const canopen_row *row, uint16_t index, uint8_t sub, uint32_t value);
/* A COB-ID as the dictionary shows it, and back: abort code, 0 iff the identifier is free for use. */
uint32_t canopen_cob_id(uint16_t stored);
uint32_t canopen_store_cob_id(uint16_t *stored, uint32_t value);
void canopen_put(uint8_t *bytes, uint32_t value, uint8_t count);
uint32_t canopen_get(const uint8_t *bytes, uint8_t count);

/* sdo.c */
void canopen_sdo(const canopen_node *on, const uint8_t request[8]);

/* pdo.c */
void canopen_start_pdos(const canopen_node *on);
uint32_t canopen_pdo_read(const canopen_axis *axis, uint16_t index, uint8_t sub, uint32_t *value);
uint32_t canopen_pdo_write(const canopen_node *on, uint16_t index, uint8_t sub, uint32_t value);
void canopen_pdos_begin(const canopen_node *on); /* at the transition to operational */
bool canopen_take_pdo(const canopen_node *on, const laconic_frame *frame);
void canopen_sync(const canopen_node *on);
void canopen_find_due_pdos(const canopen_node *on);
void canopen_check_deadlines(const canopen_node *on);
void canopen_send_pdo(const canopen_node *on, int k, laconic_frame *frame);

/* emergency.c */
void canopen_emergency(canopen_axis *axis, uint16_t code);
void canopen_all_clear(canopen_axis *axis);
void canopen_connection_lost(const canopen_node *on, uint16_t code);
void canopen_send_emergency(const canopen_node *on, laconic_frame *frame);

/* canopen.c */
void canopen_set_nmt(const canopen_node *on, uint8_t nmt);

/* state.c */
void canopen_control(const canopen_node *on, uint16_t before);
uint16_t canopen_statusword(const canopen_node *on);
void canopen_go(const canopen_node *on, uint8_t state);
void canopen_stop(const canopen_node *on, int option, uint8_t ending);
void canopen_fault(const canopen_node *on, uint16_t code);
void canopen_connection_option(const canopen_node *on, uint16_t code);
void canopen_watch_drive(const canopen_node *on);

/* motion.c */
laconic_real canopen_actual_speed(const laconic_wheel_drive *drive); /* counts/s */
int32_t canopen_rounded(laconic_real value);
uint16_t canopen_mode_bits(const canopen_node *on);
bool canopen_has_mode(int8_t mode);
void canopen_begin_motion(const canopen_node *on);
void canopen_take_mode(const canopen_node *on); /* of 0x6060 */
void canopen_new_set_point(const canopen_node *on, uint16_t before);
void canopen_move(const canopen_node *on);

#endif
