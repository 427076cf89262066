/* The state machine of CiA 402. A controlword is a command; the table says where it leads from each state, and option
 * codes whether the drive slows down first. While it does, it stays in the state that it leaves. */
#include "canopen.h"

typedef enum command { DISABLE_VOLTAGE, QUICK_STOP, SHUT_DOWN, SWITCH_ON, ENABLE_OPERATION, COMMANDS } command;

/* STAY: the command is passed over, but it ends a ramp to another state. */
enum { STAY = 0xFF };

static const uint8_t next[CANOPEN_QUICK_STOP + 1][COMMANDS] = {
    [CANOPEN_DISABLED] = {STAY, STAY, CANOPEN_READY, STAY, STAY},
    [CANOPEN_READY] = {CANOPEN_DISABLED, CANOPEN_DISABLED, STAY, CANOPEN_SWITCHED_ON, CANOPEN_ENABLED},
    [CANOPEN_SWITCHED_ON] = {CANOPEN_DISABLED, CANOPEN_DISABLED, CANOPEN_READY, STAY, CANOPEN_ENABLED},
    [CANOPEN_ENABLED] = {CANOPEN_DISABLED, CANOPEN_QUICK_STOP, CANOPEN_READY, CANOPEN_SWITCHED_ON, STAY},
    [CANOPEN_QUICK_STOP] = {CANOPEN_DISABLED, STAY, STAY, STAY, CANOPEN_ENABLED},
};

static command command_of(uint16_t word) {
    if ((word & 2U) == 0) return DISABLE_VOLTAGE;
    if ((word & 4U) == 0) return QUICK_STOP;
    if ((word & 1U) == 0) return SHUT_DOWN;
    return (word & 8U) == 0 ? SWITCH_ON : ENABLE_OPERATION;
}

/* Faults that CANopen finds are faults of the drive, too, for whoever watches drives of all protocols. */
static void tell_drive(const canopen_node *on) {
    const uint16_t code = on->axis->error_code;
    if (code == 0x8611)
        laconic_drive_fail(on->drive, LACONIC_DRIVE_FAULT_FOLLOWING);
    else if (code >= 0x8100 && code < 0x8300)
        laconic_drive_fail(on->drive, LACONIC_DRIVE_FAULT_WATCHDOG);
}

void canopen_go(const canopen_node *on, uint8_t state) {
    canopen_axis *axis = on->axis;
    axis->state = state;
    axis->ending = CANOPEN_NO_ENDING;
    if (state == CANOPEN_ENABLED) {
        canopen_begin_motion(on);
    } else if (state < CANOPEN_ENABLED || state == CANOPEN_FAULT) {
        on->drive->target.mode = LACONIC_DRIVE_OFF;
        axis->speed = 0;
        if (state == CANOPEN_FAULT) tell_drive(on);
    }
}

/* Option 0: at once; 1, 5: along 0x6084; 2, 6: along 0x6085. */
void canopen_stop(const canopen_node *on, int option, uint8_t ending) {
    on->axis->ramp = (option & 3) == 2 ? 2 : 1;
    on->axis->ending = ending;
    if (option == 0) canopen_go(on, ending);
}

/* Options 5 and 6 stay in the state of the quick stop; 1 and 2 leave it at standstill. */
static void quick_stop(const canopen_node *on) {
    const int16_t option = on->axis->quick_stop_option;
    canopen_go(on, option == 0 ? CANOPEN_DISABLED : CANOPEN_QUICK_STOP);
    if (option != 0) canopen_stop(on, option, option > 4 ? CANOPEN_QUICK_STOP : CANOPEN_DISABLED);
}

static void reset_fault(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    if (axis->state != CANOPEN_FAULT) return;
    laconic_drive_clear(on->drive);
    if (on->drive->faults != 0) return; /* the cause remains */
    axis->error_code = 0;
    axis->trouble &= CANOPEN_LISTENS;
    canopen_go(on, CANOPEN_DISABLED);
    canopen_all_clear(axis);
}

static void leave_enabled(const canopen_node *on, uint8_t to) {
    canopen_axis *axis = on->axis;
    switch (to) {
    case STAY:
        if (axis->ending != CANOPEN_NO_ENDING) canopen_go(on, CANOPEN_ENABLED);
        break;
    case CANOPEN_QUICK_STOP: quick_stop(on); break;
    case CANOPEN_READY: canopen_stop(on, axis->shutdown_option, to); break;
    case CANOPEN_SWITCHED_ON: canopen_stop(on, axis->disable_option, to); break;
    default: canopen_go(on, to); break;
    }
}

void canopen_control(const canopen_node *on, uint16_t before) {
    canopen_axis *axis = on->axis;
    const uint16_t word = axis->controlword;
    if ((word & ~before & CANOPEN_RESET) != 0) reset_fault(on);
    if ((word & CANOPEN_RESET) != 0 || axis->state > CANOPEN_QUICK_STOP) return;
    const uint8_t to = next[axis->state][command_of(word)];
    if (axis->state == CANOPEN_ENABLED) {
        leave_enabled(on, to);
    } else if (to != STAY &&
               (axis->state != CANOPEN_QUICK_STOP || to != CANOPEN_ENABLED || axis->quick_stop_option > 4)) {
        canopen_go(on, to);
    }
    if (axis->state == CANOPEN_ENABLED) canopen_new_set_point(on, before);
}

uint16_t canopen_statusword(const canopen_node *on) {
    static const uint8_t words[] = {0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08};
    enum { VOLTAGE_ENABLED = 16, REMOTE = 512 };
    uint16_t word = words[on->axis->state] | REMOTE;
    if ((on->drive->faults & LACONIC_DRIVE_FAULT_SUPPLY) == 0) word |= VOLTAGE_ENABLED;
    return word | canopen_mode_bits(on);
}

/* A fault of the drive itself leaves it without current; any other stops it by 0x605E. */
void canopen_fault(const canopen_node *on, uint16_t code) {
    canopen_axis *axis = on->axis;
    if (axis->state >= CANOPEN_FAULT_REACTION) return;
    const bool can_brake = axis->state >= CANOPEN_ENABLED && on->drive->faults == 0 && axis->fault_option != 0;
    axis->error_code = code;
    canopen_emergency(axis, code);
    canopen_go(on, can_brake ? CANOPEN_FAULT_REACTION : CANOPEN_FAULT);
    if (can_brake) canopen_stop(on, axis->fault_option, CANOPEN_FAULT);
}

void canopen_connection_option(const canopen_node *on, uint16_t code) {
    const uint8_t state = on->axis->state;
    switch (on->axis->connection_option) {
    case 1: canopen_fault(on, code); break;
    case 2:
        if (state < CANOPEN_FAULT_REACTION) canopen_go(on, CANOPEN_DISABLED);
        break;
    case 3:
        if (state == CANOPEN_ENABLED) quick_stop(on);
        break;
    default: break;
    }
}

void canopen_watch_drive(const canopen_node *on) {
    static const struct {
        uint8_t fault;
        uint16_t code;
    } codes[] = {{LACONIC_DRIVE_FAULT_ENCODER, 0x7305},     {LACONIC_DRIVE_FAULT_STALL, 0x7121},
                 {LACONIC_DRIVE_FAULT_TEMPERATURE, 0x4310}, {LACONIC_DRIVE_FAULT_OVERSPEED, 0x8400},
                 {LACONIC_DRIVE_FAULT_SUPPLY, 0x3220},      {LACONIC_DRIVE_FAULT_WATCHDOG, 0x8100},
                 {LACONIC_DRIVE_FAULT_FOLLOWING, 0x8611},   {LACONIC_DRIVE_FAULT_TARGET, 0x6320}};
    canopen_axis *axis = on->axis;
    const uint32_t faults = on->drive->faults;
    if (faults == 0) return;
    for (unsigned k = 0; k < sizeof codes / sizeof codes[0]; k++) {
        if ((faults & codes[k].fault) != 0) canopen_fault(on, codes[k].code);
    }
    if (axis->state == CANOPEN_FAULT_REACTION) canopen_go(on, CANOPEN_FAULT); /* it failed while it braked */
}
