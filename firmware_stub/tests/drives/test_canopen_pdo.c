/* Tests of pdo.c: the usual mapping after power-up, mapping at run time, and when frames are sent and take effect. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

enum { RPDO1 = 0x200 + ID, RPDO2 = 0x300 + ID, TPDO1 = 0x180 + ID, TPDO2 = 0x280 + ID, TPDO3 = 0x380 + ID };

#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})

static void after_power_up_the_usual_objects_are_mapped(void) {
    static const uint32_t mapped[8][2] = {{0x60400010, 0x60600008}, {0x60FF0020, 0},         {0x607A0020, 0},
                                          {0x60710010, 0},          {0x60410010, 0},         {0x60640020, 0x606C0020},
                                          {0x60770010, 0x60780010}, {0x60F40020, 0x60610008}};
    for (int k = 0; k < 8; k++) {
        const uint16_t base = (uint16_t)((k < 4 ? 0x1600 : 0x1A00) + k % 4);
        TEST_ASSERT_EQUAL(mapped[k][1] != 0 ? 2 : 1, get(base, 0));
        TEST_ASSERT_EQUAL_HEX32(mapped[k][0], get(base, 1));
        TEST_ASSERT_EQUAL_HEX32(mapped[k][1], get(base, 2));
        TEST_ASSERT_EQUAL_HEX32((k < 4 ? 0x200 : 0x180) + 0x100 * (k % 4) + ID,
                                get((uint16_t)(base - 0x200), 1) & 0x7FF);
    }
}

static void process_data_flow_only_in_the_state_operational(void) {
    forget();
    deliver(RPDO1, BYTES(6, 0, 9), 3);
    sync();
    step(5);
    TEST_ASSERT_EQUAL(0, on.count);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    start_nodes();
    TEST_ASSERT_EQUAL(1, count_of(TPDO1)); /* tells where the drive is */
    deliver(RPDO1, BYTES(6, 0, 9), 3);
    TEST_ASSERT_EQUAL(2, count_of(TPDO1));
    TEST_ASSERT_EQUAL_HEX16(0x0231, canopen_get(last(TPDO1)->data, 2));
    TEST_ASSERT_EQUAL(9, get(0x6061, 0));
    nmt(128, ID);
    forget();
    deliver(RPDO1, BYTES(7, 0, 9), 3);
    TEST_ASSERT_EQUAL(0, on.count);
}

/* Sets COB-ID with bit 31, number 0, the objects, the number, and switches on: what every configurator does. */
static uint32_t map(uint16_t communication, uint8_t type, const uint32_t *objects, uint8_t count) {
    const uint16_t mapping = (uint16_t)(communication + 0x200);
    const uint32_t id = (uint32_t)get(communication, 1);
    set(communication, 1, id | 0x80000000U);
    set(communication, 2, type);
    set(mapping, 0, 0);
    for (uint8_t k = 0; k < count; k++) {
        const uint32_t abort = write_as(mapping, (uint8_t)(k + 1), objects[k], 4);
        if (abort != 0) return abort;
    }
    const uint32_t abort = write_as(mapping, 0, count, 1);
    if (abort == 0) set(communication, 1, id & 0x7FFFFFFFU);
    return abort;
}

static void a_mapping_can_be_changed(void) {
    static const uint32_t wanted[4] = {0x60410010, 0x606C0020, 0x60610008, 0x10010008};
    TEST_ASSERT_EQUAL_HEX32(0, map(0x1802, 1, wanted, 4));
    start_nodes();
    forget();
    sync();
    TEST_ASSERT_EQUAL(8, last(TPDO3)->length);
    TEST_ASSERT_EQUAL_HEX16(0x0250, canopen_get(last(TPDO3)->data, 2));
}

static void dummies_skip_bytes_of_a_received_frame(void) {
    static const uint32_t wanted[3] = {0x00050008, 0x00060010, 0x60FF0020};
    TEST_ASSERT_EQUAL_HEX32(0, map(0x1401, 255, wanted, 3));
    start_nodes();
    deliver(RPDO2, BYTES(1, 2, 3, 0x10, 0x20, 0x30, 0), 7);
    TEST_ASSERT_EQUAL_HEX32(0x00302010, get(0x60FF, 0));
}

static void wrong_mappings_have_their_abort_codes(void) {
    static const struct {
        uint32_t object, code;
        uint16_t pdo;
    } wrong[] = {
        {0x20000008, CANOPEN_NO_OBJECT, 0x1400},    {0x60400110, CANOPEN_NO_SUB, 0x1400},
        {0x60410010, CANOPEN_NOT_MAPPABLE, 0x1400}, /* is sent only */
        {0x60FF0020, CANOPEN_NOT_MAPPABLE, 0x1800}, /* is received only */
        {0x60400008, CANOPEN_NOT_MAPPABLE, 0x1400}, /* 16 bits long */
        {0x10000020, CANOPEN_NOT_MAPPABLE, 0x1800}, {0x60C20108, CANOPEN_NOT_MAPPABLE, 0x1400},
        {0x00050008, CANOPEN_NOT_MAPPABLE, 0x1800}, {0x10080020, CANOPEN_NOT_MAPPABLE, 0x1800},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        TEST_ASSERT_EQUAL_HEX32(wrong[k].code, map(wrong[k].pdo, 255, &wrong[k].object, 1));
        TEST_ASSERT_EQUAL(0, get((uint16_t)(wrong[k].pdo + 0x200), 0));
        power_up();
    }
    static const uint32_t long_[3] = {0x60640020, 0x606C0020, 0x60410010}, five[4] = {0x60410010};
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_PDO_TOO_LONG, map(0x1800, 255, long_, 3));
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_NOT_MAPPABLE, map(0x1801, 255, five, 1) | write_as(0x1A02, 0, 1, 1) |
                                                      map(0x1803, 255, (const uint32_t[2]){0x60410010, 0}, 2));
    set(0x1800, 1, (int64_t)(0xC0000180U + ID));
    set(0x1A00, 0, 0);
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_PDO_TOO_LONG, write_as(0x1A00, 0, 5, 1));
    set(0x1A00, 0, 2);
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_PRESENT_STATE, write_as(0x1A00, 1, 0x60410010, 4)); /* number is not 0 */
}

static void identifiers_of_pdos_can_be_changed_and_swapped(void) {
    set(0x1400, 1, 0x80000000U | (0x200 + ID));
    set(0x1400, 1, 0x80000000U | 0x321);
    set(0x1400, 1, 0x321);
    set(0x1401, 1, 0x40000300 + ID); /* bit 30 is that of sent ones */
    start_nodes();
    deliver(RPDO2, BYTES(9), 4);
    TEST_ASSERT_EQUAL(9, get(0x60FF, 0));
    deliver(RPDO1, BYTES(6, 0, 9), 3);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    deliver(0x321, BYTES(6, 0, 9), 3);
    TEST_ASSERT_EQUAL_HEX16(READY, state());
}

/* --- receiving --------------------------------------------------------------------------------------------------- */

static void synchronous_data_take_effect_at_the_next_sync_together(void) {
    const uint32_t speed = 0x60FF0020;
    TEST_ASSERT_EQUAL_HEX32(0, map(0x1401, 1, &speed, 1));
    start_nodes();
    deliver(RPDO2, BYTES(1), 4);
    TEST_ASSERT_EQUAL(0, get(0x60FF, 0));
    deliver(RPDO2, BYTES(2), 4);
    sync();
    TEST_ASSERT_EQUAL(2, get(0x60FF, 0));
    set(0x60FF, 0, 7);
    sync(); /* nothing new came */
    TEST_ASSERT_EQUAL(7, get(0x60FF, 0));
}

/* 240 is the last type that waits, 254 the first that does not. */
static void received_data_wait_for_sync_by_the_types_up_to_240(void) {
    static const uint8_t types[] = {0, 1, 239, 240, 254, 255};
    const uint32_t speed = 0x60FF0020;
    for (size_t k = 0; k < sizeof types; k++) {
        power_up();
        TEST_ASSERT_EQUAL_HEX32(0, map(0x1401, types[k], &speed, 1));
        start_nodes();
        deliver(RPDO2, BYTES(7), 4);
        TEST_ASSERT_EQUAL(types[k] <= 240 ? 0 : 7, get(0x60FF, 0));
        sync();
        TEST_ASSERT_EQUAL(7, get(0x60FF, 0));
    }
}

static void a_frame_that_is_too_short_is_told_once_and_not_used(void) {
    start_nodes();
    forget();
    deliver(RPDO1, BYTES(6, 0), 2);
    deliver(RPDO1, BYTES(6), 1);
    TEST_ASSERT_EQUAL(1, count_of(0x80 + ID));
    TEST_ASSERT_EQUAL_HEX16(0x8210, canopen_get(last(0x80 + ID)->data, 2));
    TEST_ASSERT_EQUAL_HEX8(17, last(0x80 + ID)->data[2]);
    deliver(RPDO1, BYTES(6, 0, 9, 77), 4); /* longer: the rest is ignored */
    TEST_ASSERT_EQUAL_HEX16(0, canopen_get(last(0x80 + ID)->data, 2));
    TEST_ASSERT_EQUAL_HEX16(READY, state());
}

static void a_value_that_an_object_refuses_leaves_it_as_it_was(void) {
    const uint32_t torque = 0x60720010;
    TEST_ASSERT_EQUAL_HEX32(0, map(0x1403, 255, &torque, 1));
    start_nodes();
    deliver(0x500 + ID, BYTES(0xE9, 3), 2); /* 1001 */
    TEST_ASSERT_EQUAL(1000, get(0x6072, 0));
    deliver(0x500 + ID, BYTES(0xF4, 1), 2);
    TEST_ASSERT_EQUAL(500, get(0x6072, 0));
}

/* --- sending ----------------------------------------------------------------------------------------------------- */

static void synchronous_data_are_sent_at_every_nth_sync(void) {
    set(0x1801, 2, 3);
    start_nodes();
    forget();
    for (int k = 1; k <= 9; k++) {
        sync();
        TEST_ASSERT_EQUAL(k / 3, count_of(TPDO2));
    }
    TEST_ASSERT_EQUAL(9, count_of(0x280 + OTHER_ID));
}

static void acyclic_synchronous_data_are_sent_at_a_sync_after_a_change(void) {
    set(0x1800, 2, 0);
    start_nodes();
    sync();
    forget();
    sync();
    TEST_ASSERT_EQUAL(0, count_of(TPDO1));
    control(6);
    forget();
    sync();
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    sync();
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
}

static void a_remote_request_is_answered_iff_the_pdo_allows_it(void) {
    laconic_frame ask = {.id = TPDO2, .remote = true};
    start_nodes();
    forget();
    laconic_canopen.on_frame(&on.drives, &ask, on.now_us);
    collect();
    TEST_ASSERT_EQUAL(0, count_of(TPDO2));
    set(0x1801, 1, (int64_t)(0x80000280U + ID));
    set(0x1801, 1, 0x280 + ID);
    laconic_canopen.on_frame(&on.drives, &ask, on.now_us);
    collect();
    TEST_ASSERT_EQUAL(1, count_of(TPDO2));
}

static void data_that_wait_for_sync_are_dropped_with_their_pdo(void) {
    set(0x1401, 2, 1);
    start_nodes();
    deliver(RPDO2, BYTES(7), 4);
    set(0x1401, 1, (int64_t)(0x80000300U + ID));
    sync();
    set(0x1401, 1, 0x300 + ID);
    sync();
    TEST_ASSERT_EQUAL(0, get(0x60FF, 0));
}

static void a_sync_that_changes_the_state_tells_it_at_once(void) {
    set(0x1400, 2, 1);
    start_nodes();
    deliver(RPDO1, BYTES(6, 0, 9), 3);
    forget();
    sync();
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    TEST_ASSERT_EQUAL_HEX8(READY, last(TPDO1)->data[0] & 0x6F);
}

static void every_pdo_by_event_is_sent_when_its_node_starts(void) {
    for (uint16_t k = 0; k < 4; k++) {
        const uint32_t id = 0x180U + 0x100U * k + ID;
        set((uint16_t)(0x1800 + k), 1, (int64_t)(0x80000000U | id));
        set((uint16_t)(0x1800 + k), 2, k < 3 ? 254 : 240);
        set((uint16_t)(0x1800 + k), 1, id);
    }
    forget();
    start_nodes();
    for (int k = 0; k < 4; k++) TEST_ASSERT_EQUAL(k < 3, count_of((uint32_t)(TPDO1 + 0x100 * k)));
}

static void process_data_that_were_due_are_dropped_with_the_state_operational(void) {
    for (uint8_t command = 2; command != 0; command = command == 2 ? 128 : 0) {
        power_up();
        start_nodes();
        forget();
        on.count = KEPT; /* a busy bus */
        sync();
        deliver(0x600 + ID, BYTES(0x40, 0x00, 0x10), 8);
        nmt(command, ID);
        forget();
        collect();
        TEST_ASSERT_EQUAL(0, count_of(TPDO2));
        TEST_ASSERT_EQUAL(command == 128, count_of(0x580 + ID)); /* a stopped node has no SDO either */
    }
}

static void an_answer_that_is_due_stays_when_the_node_starts(void) {
    on.count = KEPT;
    deliver(0x600 + ID, BYTES(0x40, 0x00, 0x10), 8);
    start_nodes();
    forget();
    collect();
    TEST_ASSERT_EQUAL(1, count_of(0x580 + ID));
}

static void after_power_up_types_and_times_are_as_the_page_says(void) {
    static const int types[8] = {255, 255, 255, 255, 255, 1, 1, 1};
    for (int k = 0; k < 8; k++) {
        const uint16_t base = (uint16_t)((k < 4 ? 0x1400 : 0x1800) + k % 4);
        TEST_ASSERT_EQUAL_UINT8(types[k], get(base, 2));
        TEST_ASSERT_EQUAL(k == 4 ? 100 : 0, get(base, 5));
        if (k >= 4) TEST_ASSERT_EQUAL(0, get(base, 3));
        if (k >= 4) TEST_ASSERT_EQUAL_HEX8(k >= 6 ? 3 : 1, (uint32_t)get(base, 1) >> 30); /* off, no remote request */
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(after_power_up_the_usual_objects_are_mapped);
    RUN_TEST(process_data_flow_only_in_the_state_operational);
    RUN_TEST(a_mapping_can_be_changed);
    RUN_TEST(dummies_skip_bytes_of_a_received_frame);
    RUN_TEST(wrong_mappings_have_their_abort_codes);
    RUN_TEST(identifiers_of_pdos_can_be_changed_and_swapped);
    RUN_TEST(synchronous_data_take_effect_at_the_next_sync_together);
    RUN_TEST(received_data_wait_for_sync_by_the_types_up_to_240);
    RUN_TEST(a_frame_that_is_too_short_is_told_once_and_not_used);
    RUN_TEST(a_value_that_an_object_refuses_leaves_it_as_it_was);
    RUN_TEST(synchronous_data_are_sent_at_every_nth_sync);
    RUN_TEST(acyclic_synchronous_data_are_sent_at_a_sync_after_a_change);
    RUN_TEST(a_remote_request_is_answered_iff_the_pdo_allows_it);
    RUN_TEST(data_that_wait_for_sync_are_dropped_with_their_pdo);
    RUN_TEST(a_sync_that_changes_the_state_tells_it_at_once);
    RUN_TEST(every_pdo_by_event_is_sent_when_its_node_starts);
    RUN_TEST(process_data_that_were_due_are_dropped_with_the_state_operational);
    RUN_TEST(an_answer_that_is_due_stays_when_the_node_starts);
    RUN_TEST(after_power_up_types_and_times_are_as_the_page_says);
    return UNITY_END();
}
