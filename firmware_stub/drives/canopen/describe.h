/* The object dictionary of a CANopen drive for tools: the EDS file is made from it. */
#ifndef LACONIC_CANOPEN_DESCRIBE_H
#define LACONIC_CANOPEN_DESCRIBE_H

#include <stdbool.h>
#include <stdint.h>

/* The settings of a drive that its dictionary shows. */
typedef struct laconic_canopen_drive {
    int32_t node_id, encoder_counts;
    double torque_constant_Nm_per_A, current_limit_A, supply_V;
} laconic_canopen_drive;

typedef struct laconic_canopen_object {
    uint16_t index;
    uint8_t sub;
    uint8_t type;               /* data type of CiA 301: 2 INTEGER8 … 7 UNSIGNED32, 9 VISIBLE_STRING             */
    uint8_t access;             /* bits 16 read, 32 write, 64 in a PDO that is sent, 128 in one that is received */
    uint8_t group;              /* of the index: 0 a variable, 8 an array, 9 a record                            */
    bool is_one_of_many;        /* the row of the dictionary stands for several sub-indices                      */
    bool has_value, has_limits; /* has_limits: the range is narrower than the type's                             */
    int64_t value, low, high;   /* value: after power-up                                                         */
    const char *name, *group_name;
} laconic_canopen_object;

/* Object `number` of a drive, in the order of the dictionary; false iff there are no more. */
bool laconic_canopen_describe(uint32_t number, const laconic_canopen_drive *of, laconic_canopen_object *object);

#endif
