/* Checks the numbers of drives before they play. */
#include "laconic_drives/settings.h"

#include <string.h>

void laconic_drive_plan_begin(laconic_drive_plan *plan) {
    memset(plan, 0, sizeof *plan);
    for (int32_t i = 0; i < LACONIC_DRIVE_AXES; i++) plan->drive[i].node_id = -1;
}

typedef struct checked_number {
    uint16_t offset; /* in laconic_drive_settings */
    uint8_t field, kind, rule;
} checked_number;

#define ROW(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    {offsetof(laconic_drive_settings, member), number, LACONIC_KIND_##KIND, LACONIC_RULE_##RULE},

static const checked_number numbers[] = {LACONIC_DRIVES_WHEEL_ROWS(ROW, )};

static laconic_status refuse(laconic_refusal *why, laconic_status status, int32_t field, int32_t item,
                             laconic_real value, laconic_real limit) {
    const laconic_refusal refusal = {status, (laconic_field)field, item, value, limit};
    if (why != NULL) *why = refusal;
    return status;
}

static laconic_status status_of(laconic_real value, uint8_t rule) {
    if (!(value - value == 0)) return LACONIC_NOT_FINITE;
    if (rule == LACONIC_RULE_POSITIVE && value <= 0) return LACONIC_NOT_POSITIVE;
    if (rule == LACONIC_RULE_NOT_ZERO && value == 0) return LACONIC_NOT_POSITIVE;
    return rule == LACONIC_RULE_NOT_NEGATIVE && value < 0 ? LACONIC_NEGATIVE : LACONIC_OK;
}

static laconic_status check_drive(const laconic_drive_settings *settings, int32_t item, laconic_refusal *why) {
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        const uint8_t *at = (const uint8_t *)settings + numbers[k].offset;
        laconic_real value;
        int32_t whole;
        memcpy(&whole, at, sizeof whole);
        memcpy(&value, at, sizeof value);
        if (numbers[k].kind == LACONIC_KIND_INTEGER) value = (laconic_real)whole;
        const laconic_status status = status_of(value, numbers[k].rule);
        if (status != LACONIC_OK) return refuse(why, status, numbers[k].field, item, value, 0);
    }
    return LACONIC_OK;
}

static bool is_taken(const laconic_drive_plan *plan, int32_t node_id, int32_t before) {
    for (int32_t i = 0; i < before; i++)
        if (plan->drive[i].node_id == node_id) return true;
    return false;
}

static laconic_status check_id(const laconic_drive_plan *plan, const laconic_drive_protocol *protocol,
                               int32_t wheel_count, int32_t i, laconic_refusal *why) {
    const int32_t id = plan->drive[i].node_id;
    const bool of_protocol = id >= protocol->first_id && id <= protocol->last_id;
    if (i < wheel_count && of_protocol && !is_taken(plan, id, i)) return LACONIC_OK;
    return refuse(why, LACONIC_ABOVE_LIMIT, LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, i + 1, (laconic_real)id,
                  (laconic_real)protocol->last_id);
}

laconic_status laconic_drive_plan_check(const laconic_drive_plan *plan, const laconic_drive_protocol *protocol,
                                        int32_t wheel_count, laconic_refusal *why) {
    laconic_status status = status_of(plan->watchdog_s, LACONIC_RULE_NOT_NEGATIVE);
    if (status == LACONIC_OK && plan->watchdog_s > 1000) status = LACONIC_ABOVE_LIMIT;
    if (status != LACONIC_OK)
        return refuse(why, status, LACONIC_DRIVES_FIELD_DRIVE_WATCHDOG, 0, plan->watchdog_s, 1000);
    for (int32_t i = 0; i < LACONIC_DRIVE_AXES; i++) {
        if (plan->drive[i].node_id < 0) continue;
        status = check_id(plan, protocol, wheel_count, i, why);
        if (status == LACONIC_OK) status = check_drive(&plan->drive[i], i + 1, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}
