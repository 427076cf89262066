/* The object dictionary of a drive: the one list from which its table in flash, its values after a reset and its EDS
 * file follow.
 *
 *   GROUP(index, object type, name)                                     an array or a record: its name, for the EDS
 *   FIELD(index, sub, last, type, access, member, after reset, name)    a member of canopen_axis
 *   VALUE(index, sub, last, type, access, value, name)                  a constant below 65,536
 *   CALL(index, sub, last, type, access, what, name)                    object_access.c or pdo.c knows it: canopen_call
 *
 * A row stands for the sub-indices sub … last. The rows of 0x1400, 0x1600, 0x1800 and 0x1A00 stand for four indices.
 * Access: CANOPEN_R and CANOPEN_W over SDO, CANOPEN_TX and CANOPEN_RX in a PDO that the drive sends or receives. A row
 * that CALL or VALUE makes writable takes only the value that it has, unless object_access.c says otherwise: a
 * controller that configures what the drive is gets on, and one that believes in another drive is told. */
#ifndef LACONIC_CANOPEN_OBJECTS_H
#define LACONIC_CANOPEN_OBJECTS_H

/* What is behind the rows of CALL. */
typedef enum canopen_call {
    CANOPEN_CALL_PDO, /* pdo.c */
    CANOPEN_CALL_HISTORY,
    CANOPEN_CALL_TEXT,
    CANOPEN_CALL_DEVICE_TYPE,
    CANOPEN_CALL_SYNC_ID,
    CANOPEN_CALL_EMERGENCY_ID,
    CANOPEN_CALL_SDO_ID,
    CANOPEN_CALL_SERIAL_NUMBER,
    CANOPEN_CALL_STATUSWORD,
    CANOPEN_CALL_DEMAND,
    CANOPEN_CALL_POSITION,
    CANOPEN_CALL_FOLLOWING_ERROR,
    CANOPEN_CALL_DEMAND_SPEED,
    CANOPEN_CALL_SPEED,
    CANOPEN_CALL_TORQUE,
    CANOPEN_CALL_SUPPLY,
    CANOPEN_CALL_RATED_CURRENT,
    CANOPEN_CALL_RATED_TORQUE,
    CANOPEN_CALL_COUNTS,
    CANOPEN_CALL_POSITION_UNIT,
    CANOPEN_CALL_SPEED_UNIT,
    CANOPEN_CALL_ACCELERATION_UNIT
} canopen_call;

/* CiA 301: the device and its communication. */
#define CANOPEN_DEVICE_OBJECTS(GROUP, FIELD, VALUE, CALL) \
    VALUE(0x0002, 0, 0, CANOPEN_I8, CANOPEN_RX, 0, "Dummy 8 bit") \
    VALUE(0x0003, 0, 0, CANOPEN_I16, CANOPEN_RX, 0, "Dummy 16 bit") \
    VALUE(0x0004, 0, 0, CANOPEN_I32, CANOPEN_RX, 0, "Dummy 32 bit") \
    VALUE(0x0005, 0, 0, CANOPEN_U8, CANOPEN_RX, 0, "Dummy unsigned 8 bit") \
    VALUE(0x0006, 0, 0, CANOPEN_U16, CANOPEN_RX, 0, "Dummy unsigned 16 bit") \
    VALUE(0x0007, 0, 0, CANOPEN_U32, CANOPEN_RX, 0, "Dummy unsigned 32 bit") \
    CALL(0x1000, 0, 0, CANOPEN_U32, CANOPEN_R, DEVICE_TYPE, "Device type") \
    FIELD(0x1001, 0, 0, CANOPEN_U8, CANOPEN_R | CANOPEN_TX, error_register, 0, "Error register") \
    GROUP(0x1003, CANOPEN_ARRAY, "Pre-defined error field") \
    CALL(0x1003, 0, 0, CANOPEN_U8, CANOPEN_R | CANOPEN_W, HISTORY, "Number of errors") \
    CALL(0x1003, 1, CANOPEN_HISTORY, CANOPEN_U32, CANOPEN_R, HISTORY, "Error field") \
    CALL(0x1005, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, SYNC_ID, "COB-ID SYNC") \
    CALL(0x1008, 0, 0, CANOPEN_STRING, CANOPEN_R, TEXT, "Manufacturer device name") \
    CALL(0x1009, 0, 0, CANOPEN_STRING, CANOPEN_R, TEXT, "Manufacturer hardware version") \
    CALL(0x100A, 0, 0, CANOPEN_STRING, CANOPEN_R, TEXT, "Manufacturer software version") \
    CALL(0x1014, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, EMERGENCY_ID, "COB-ID EMCY") \
    GROUP(0x1016, CANOPEN_ARRAY, "Consumer heartbeat time") \
    VALUE(0x1016, 0, 0, CANOPEN_U8, CANOPEN_R, 1, "Highest sub-index") \
    FIELD(0x1016, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, consumer, 0, "Consumer heartbeat time") \
    FIELD(0x1017, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W, producer_ms, 0, "Producer heartbeat time") \
    GROUP(0x1018, CANOPEN_RECORD, "Identity object") \
    VALUE(0x1018, 0, 0, CANOPEN_U8, CANOPEN_R, 4, "Highest sub-index") \
    VALUE(0x1018, 1, 1, CANOPEN_U32, CANOPEN_R, 0, "Vendor-ID") \
    VALUE(0x1018, 2, 2, CANOPEN_U32, CANOPEN_R, 402, "Product code") \
    VALUE(0x1018, 3, 3, CANOPEN_U32, CANOPEN_R, 1, "Revision number") \
    CALL(0x1018, 4, 4, CANOPEN_U32, CANOPEN_R, SERIAL_NUMBER, "Serial number") \
    GROUP(0x1029, CANOPEN_ARRAY, "Error behaviour") \
    VALUE(0x1029, 0, 0, CANOPEN_U8, CANOPEN_R, 1, "Highest sub-index") \
    FIELD(0x1029, 1, 1, CANOPEN_U8, CANOPEN_R | CANOPEN_W, behaviour, 0, "Communication error") \
    GROUP(0x1200, CANOPEN_RECORD, "SDO server parameter") \
    VALUE(0x1200, 0, 0, CANOPEN_U8, CANOPEN_R, 2, "Highest sub-index") \
    CALL(0x1200, 1, 1, CANOPEN_U32, CANOPEN_R, SDO_ID, "COB-ID client to server") \
    CALL(0x1200, 2, 2, CANOPEN_U32, CANOPEN_R, SDO_ID, "COB-ID server to client") \
    GROUP(0x1400, CANOPEN_RECORD, "RPDO communication parameter") \
    VALUE(0x1400, 0, 0, CANOPEN_U8, CANOPEN_R, 5, "Highest sub-index") \
    CALL(0x1400, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, PDO, "COB-ID used by RPDO") \
    CALL(0x1400, 2, 2, CANOPEN_U8, CANOPEN_R | CANOPEN_W, PDO, "Transmission type") \
    CALL(0x1400, 5, 5, CANOPEN_U16, CANOPEN_R | CANOPEN_W, PDO, "Event timer") \
    GROUP(0x1600, CANOPEN_RECORD, "RPDO mapping parameter") \
    CALL(0x1600, 0, 0, CANOPEN_U8, CANOPEN_R | CANOPEN_W, PDO, "Number of mapped objects") \
    CALL(0x1600, 1, CANOPEN_MAPPED, CANOPEN_U32, CANOPEN_R | CANOPEN_W, PDO, "Mapped object") \
    GROUP(0x1800, CANOPEN_RECORD, "TPDO communication parameter") \
    VALUE(0x1800, 0, 0, CANOPEN_U8, CANOPEN_R, 5, "Highest sub-index") \
    CALL(0x1800, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, PDO, "COB-ID used by TPDO") \
    CALL(0x1800, 2, 2, CANOPEN_U8, CANOPEN_R | CANOPEN_W, PDO, "Transmission type") \
    CALL(0x1800, 3, 3, CANOPEN_U16, CANOPEN_R | CANOPEN_W, PDO, "Inhibit time") \
    CALL(0x1800, 5, 5, CANOPEN_U16, CANOPEN_R | CANOPEN_W, PDO, "Event timer") \
    GROUP(0x1A00, CANOPEN_RECORD, "TPDO mapping parameter") \
    CALL(0x1A00, 0, 0, CANOPEN_U8, CANOPEN_R | CANOPEN_W, PDO, "Number of mapped objects") \
    CALL(0x1A00, 1, CANOPEN_MAPPED, CANOPEN_U32, CANOPEN_R | CANOPEN_W, PDO, "Mapped object")

/* CiA 402: the drive. Positions are in counts of the encoder, speeds in counts/s, accelerations in counts/s², torques
 * and currents in thousandths of the rated ones. */
#define CANOPEN_DRIVE_OBJECTS(GROUP, FIELD, VALUE, CALL) \
    FIELD(0x6007, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, connection_option, 1, "Abort connection option code") \
    FIELD(0x603F, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_TX, error_code, 0, "Error code") \
    FIELD(0x6040, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W | CANOPEN_RX, controlword, 0, "Controlword") \
    CALL(0x6041, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_TX, STATUSWORD, "Statusword") \
    FIELD(0x605A, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, quick_stop_option, 2, "Quick stop option code") \
    FIELD(0x605B, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, shutdown_option, 0, "Shutdown option code") \
    FIELD(0x605C, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, disable_option, 1, "Disable operation option code") \
    FIELD(0x605D, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, halt_option, 1, "Halt option code") \
    FIELD(0x605E, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, fault_option, 2, "Fault reaction option code") \
    FIELD(0x6060, 0, 0, CANOPEN_I8, CANOPEN_R | CANOPEN_W | CANOPEN_RX, mode, 0, "Modes of operation") \
    FIELD(0x6061, 0, 0, CANOPEN_I8, CANOPEN_R | CANOPEN_TX, mode_display, 0, "Modes of operation display") \
    CALL(0x6062, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_TX, DEMAND, "Position demand value") \
    CALL(0x6064, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_TX, POSITION, "Position actual value") \
    FIELD(0x6065, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, following_window, 0xFFFFFFFFU, "Following error window") \
    FIELD(0x6066, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W, following_ms, 10, "Following error time out") \
    FIELD(0x6067, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, position_window, 100, "Position window") \
    CALL(0x606B, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_TX, DEMAND_SPEED, "Velocity demand value") \
    CALL(0x606C, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_TX, SPEED, "Velocity actual value") \
    FIELD(0x606D, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W, speed_window, 500, "Velocity window") \
    FIELD(0x606F, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W, speed_threshold, 5, "Velocity threshold") \
    FIELD(0x6071, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W | CANOPEN_RX, target_torque, 0, "Target torque") \
    FIELD(0x6072, 0, 0, CANOPEN_U16, CANOPEN_R | CANOPEN_W | CANOPEN_RX, max_torque, 1000, "Max torque") \
    CALL(0x6075, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, RATED_CURRENT, "Motor rated current") \
    CALL(0x6076, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, RATED_TORQUE, "Motor rated torque") \
    CALL(0x6077, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_TX, TORQUE, "Torque actual value") \
    CALL(0x6078, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_TX, TORQUE, "Current actual value") \
    CALL(0x6079, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_TX, SUPPLY, "DC link circuit voltage") \
    FIELD(0x607A, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, target_position, 0, "Target position") \
    FIELD(0x607F, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, max_speed, 0x7FFFFFFF, \
          "Max profile velocity") \
    FIELD(0x6081, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, profile_speed, 10000, "Profile velocity") \
    FIELD(0x6083, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, acceleration, 100000, "Profile acceleration") \
    FIELD(0x6084, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, deceleration, 100000, "Profile deceleration") \
    FIELD(0x6085, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, quick_deceleration, 1000000, \
          "Quick stop deceleration") \
    VALUE(0x6086, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W, 0, "Motion profile type") \
    GROUP(0x608F, CANOPEN_ARRAY, "Position encoder resolution") \
    VALUE(0x608F, 0, 0, CANOPEN_U8, CANOPEN_R, 2, "Highest sub-index") \
    CALL(0x608F, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, COUNTS, "Encoder increments") \
    VALUE(0x608F, 2, 2, CANOPEN_U32, CANOPEN_R | CANOPEN_W, 1, "Motor revolutions") \
    GROUP(0x6091, CANOPEN_ARRAY, "Gear ratio") \
    VALUE(0x6091, 0, 0, CANOPEN_U8, CANOPEN_R, 2, "Highest sub-index") \
    VALUE(0x6091, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, 1, "Motor revolutions") \
    VALUE(0x6091, 2, 2, CANOPEN_U32, CANOPEN_R | CANOPEN_W, 1, "Shaft revolutions") \
    GROUP(0x6092, CANOPEN_ARRAY, "Feed constant") \
    VALUE(0x6092, 0, 0, CANOPEN_U8, CANOPEN_R, 2, "Highest sub-index") \
    CALL(0x6092, 1, 1, CANOPEN_U32, CANOPEN_R | CANOPEN_W, COUNTS, "Feed") \
    VALUE(0x6092, 2, 2, CANOPEN_U32, CANOPEN_R | CANOPEN_W, 1, "Shaft revolutions") \
    CALL(0x60A8, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, POSITION_UNIT, "SI unit position") \
    CALL(0x60A9, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, SPEED_UNIT, "SI unit velocity") \
    CALL(0x60AA, 0, 0, CANOPEN_U32, CANOPEN_R | CANOPEN_W, ACCELERATION_UNIT, "SI unit acceleration") \
    FIELD(0x60B1, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, speed_offset, 0, "Velocity offset") \
    FIELD(0x60B2, 0, 0, CANOPEN_I16, CANOPEN_R | CANOPEN_W | CANOPEN_RX, torque_offset, 0, "Torque offset") \
    GROUP(0x60C2, CANOPEN_RECORD, "Interpolation time period") \
    VALUE(0x60C2, 0, 0, CANOPEN_U8, CANOPEN_R, 2, "Highest sub-index") \
    FIELD(0x60C2, 1, 1, CANOPEN_U8, CANOPEN_R | CANOPEN_W, period, 1, "Interpolation time period value") \
    FIELD(0x60C2, 2, 2, CANOPEN_I8, CANOPEN_R | CANOPEN_W, period_exponent, -3, "Interpolation time index") \
    CALL(0x60F4, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_TX, FOLLOWING_ERROR, "Following error actual value") \
    FIELD(0x60FF, 0, 0, CANOPEN_I32, CANOPEN_R | CANOPEN_W | CANOPEN_RX, target_speed, 0, "Target velocity") \
    VALUE(0x6502, 0, 0, CANOPEN_U32, CANOPEN_R, CANOPEN_MODES, "Supported drive modes")

#define CANOPEN_OBJECTS(GROUP, FIELD, VALUE, CALL) \
    CANOPEN_DEVICE_OBJECTS(GROUP, FIELD, VALUE, CALL) \
    CANOPEN_DRIVE_OBJECTS(GROUP, FIELD, VALUE, CALL)

/* Ranges narrower than the type: LIMIT(index, sub, lowest, highest). */
#define CANOPEN_LIMITS(LIMIT) \
    LIMIT(0x1029, 1, 0, 2) \
    LIMIT(0x6007, 0, 0, 3) \
    LIMIT(0x605A, 0, 0, 6) \
    LIMIT(0x605B, 0, 0, 1) \
    LIMIT(0x605C, 0, 0, 1) \
    LIMIT(0x605D, 0, 1, 2) \
    LIMIT(0x605E, 0, 0, 2) \
    LIMIT(0x6072, 0, 0, 1000) \
    LIMIT(0x6083, 0, 1, 0xFFFFFFFFU) \
    LIMIT(0x6084, 0, 1, 0xFFFFFFFFU) \
    LIMIT(0x6085, 0, 1, 0xFFFFFFFFU) \
    LIMIT(0x60C2, 1, 1, 255) \
    LIMIT(0x60C2, 2, -6, 0)

#endif
