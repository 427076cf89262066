/* Tests of sdo.c and object_access.c: transfers, and the abort code of every kind of wrong request. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

typedef struct wrong {
    uint16_t index;
    uint8_t sub, size; /* size 0: an upload */
    uint32_t value, code;
} wrong;

static uint32_t answer_to(const wrong *the) {
    uint32_t value;
    uint8_t size;
    return the->size == 0 ? read_as(the->index, the->sub, &value, &size)
                          : write_as(the->index, the->sub, the->value, the->size);
}

static void each_wrong_request_has_its_abort_code(void) {
    static const wrong requests[] = {
        /* objects that do not exist */
        {0x1002, 0, 0, 0, CANOPEN_NO_OBJECT},
        {0x100C, 0, 0, 0, CANOPEN_NO_OBJECT}, /* node guarding */
        {0x100D, 0, 1, 3, CANOPEN_NO_OBJECT},
        {0x1010, 1, 4, 0x65766173, CANOPEN_NO_OBJECT},
        {0x1404, 1, 0, 0, CANOPEN_NO_OBJECT},
        {0x1604, 0, 0, 0, CANOPEN_NO_OBJECT},
        {0x1804, 1, 0, 0, CANOPEN_NO_OBJECT},
        {0x1A04, 0, 0, 0, CANOPEN_NO_OBJECT},
        {0x2000, 0, 0, 0, CANOPEN_NO_OBJECT},
        {0x6042, 0, 2, 1, CANOPEN_NO_OBJECT},  /* velocity mode */
        {0x6098, 0, 1, 35, CANOPEN_NO_OBJECT}, /* homing */
        {0x6099, 1, 4, 1, CANOPEN_NO_OBJECT},
        {0xFFFF, 255, 0, 0, CANOPEN_NO_OBJECT},
        {0x0000, 0, 0, 0, CANOPEN_NO_OBJECT},
        /* sub-indices that do not exist */
        {0x1000, 1, 0, 0, CANOPEN_NO_SUB},
        {0x1003, 5, 0, 0, CANOPEN_NO_SUB},
        {0x1016, 2, 0, 0, CANOPEN_NO_SUB},
        {0x1018, 5, 0, 0, CANOPEN_NO_SUB},
        {0x1400, 3, 0, 0, CANOPEN_NO_SUB},
        {0x1600, 5, 4, 0x60400010, CANOPEN_NO_SUB},
        {0x1800, 4, 0, 0, CANOPEN_NO_SUB},
        {0x1800, 6, 1, 0, CANOPEN_NO_SUB},
        {0x6040, 1, 2, 6, CANOPEN_NO_SUB},
        {0x60C2, 3, 0, 0, CANOPEN_NO_SUB},
        /* access */
        {0x0005, 0, 0, 0, CANOPEN_NO_ACCESS},
        {0x0007, 0, 4, 0, CANOPEN_NO_ACCESS},
        {0x1000, 0, 4, 0, CANOPEN_READ_ONLY},
        {0x1001, 0, 1, 0, CANOPEN_READ_ONLY},
        {0x1003, 1, 4, 0, CANOPEN_READ_ONLY},
        {0x1008, 0, 4, 0x44434241, CANOPEN_READ_ONLY},
        {0x1018, 1, 4, 0, CANOPEN_READ_ONLY},
        {0x1400, 0, 1, 5, CANOPEN_READ_ONLY},
        {0x6041, 0, 2, 0, CANOPEN_READ_ONLY},
        {0x6061, 0, 1, 9, CANOPEN_READ_ONLY},
        {0x6064, 0, 4, 0, CANOPEN_READ_ONLY},
        {0x606C, 0, 4, 0, CANOPEN_READ_ONLY},
        {0x6502, 0, 4, 0xFFFFFFFF, CANOPEN_READ_ONLY},
        /* length */
        {0x6040, 0, 1, 6, CANOPEN_TOO_SHORT},
        {0x6040, 0, 4, 6, CANOPEN_TOO_LONG},
        {0x6060, 0, 2, 9, CANOPEN_TOO_LONG},
        {0x60FF, 0, 2, 9, CANOPEN_TOO_SHORT},
        {0x60FF, 0, 3, 9, CANOPEN_TOO_SHORT},
        {0x1017, 0, 4, 9, CANOPEN_TOO_LONG},
        /* values */
        {0x1003, 0, 1, 1, CANOPEN_VALUE},
        {0x1005, 0, 4, 0x40000080, CANOPEN_VALUE}, /* the drive is no SYNC producer */
        {0x1005, 0, 4, 0x20000080, CANOPEN_VALUE}, /* 29 bits */
        {0x1005, 0, 4, 0x605, CANOPEN_VALUE},
        {0x1014, 0, 4, 0x80000000, CANOPEN_VALUE},
        {0x1014, 0, 4, 0x90, CANOPEN_PRESENT_STATE}, /* another identifier while it is in use */
        {0x1016, 1, 4, 0x00800064, CANOPEN_VALUE},   /* node 128 */
        {0x1029, 1, 1, 3, CANOPEN_TOO_HIGH},
        {0x1400, 1, 4, 0x80000605, CANOPEN_VALUE},
        {0x1400, 1, 4, 0xA0000205, CANOPEN_VALUE},
        {0x1400, 1, 4, 0x206, CANOPEN_PRESENT_STATE},
        {0x1400, 2, 1, 241, CANOPEN_VALUE},
        {0x1800, 2, 1, 252, CANOPEN_VALUE},
        {0x1800, 3, 2, 10, CANOPEN_PRESENT_STATE},
        {0x1600, 0, 1, 0, CANOPEN_PRESENT_STATE},
        {0x1A00, 1, 4, 0x60410010, CANOPEN_PRESENT_STATE},
        {0x6007, 0, 2, 4, CANOPEN_TOO_HIGH},
        {0x6007, 0, 2, 0xFFFF, CANOPEN_TOO_LOW},
        {0x605A, 0, 2, 3, CANOPEN_VALUE},
        {0x605A, 0, 2, 4, CANOPEN_VALUE},
        {0x605A, 0, 2, 7, CANOPEN_TOO_HIGH},
        {0x605B, 0, 2, 2, CANOPEN_TOO_HIGH},
        {0x605C, 0, 2, 0xFFFE, CANOPEN_TOO_LOW},
        {0x605D, 0, 2, 0, CANOPEN_TOO_LOW},
        {0x605D, 0, 2, 3, CANOPEN_TOO_HIGH},
        {0x605E, 0, 2, 3, CANOPEN_TOO_HIGH},
        {0x6060, 0, 1, 6, CANOPEN_VALUE}, /* homing */
        {0x6060, 0, 1, 2, CANOPEN_VALUE},
        {0x6060, 0, 1, 7, CANOPEN_VALUE},
        {0x6060, 0, 1, 11, CANOPEN_VALUE},
        {0x6060, 0, 1, 0xFF, CANOPEN_VALUE},
        {0x6072, 0, 2, 1001, CANOPEN_TOO_HIGH},
        {0x6083, 0, 4, 0, CANOPEN_TOO_LOW},
        {0x6085, 0, 4, 0, CANOPEN_TOO_LOW},
        {0x6086, 0, 2, 1, CANOPEN_VALUE},
        {0x608F, 1, 4, COUNTS + 1, CANOPEN_VALUE},
        {0x6091, 1, 4, 20, CANOPEN_VALUE},
        {0x6092, 1, 4, 1, CANOPEN_VALUE},
        {0x60A9, 0, 4, 0x00B44700, CANOPEN_VALUE}, /* turns per minute */
        {0x60C2, 1, 1, 0, CANOPEN_TOO_LOW},
        {0x60C2, 2, 1, 1, CANOPEN_TOO_HIGH},
        {0x60C2, 2, 1, 0xF9, CANOPEN_TOO_LOW},
        /* state */
        {0x1003, 1, 0, 0, CANOPEN_NO_DATA},
    };
    for (size_t k = 0; k < sizeof requests / sizeof requests[0]; k++) {
        char text[64];
        snprintf(text, sizeof text, "0x%04X:%u value 0x%X", requests[k].index, requests[k].sub, requests[k].value);
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(requests[k].code, answer_to(&requests[k]), text);
    }
    TEST_ASSERT_GREATER_OR_EQUAL(50, sizeof requests / sizeof requests[0]);
}

static void a_refused_request_changes_nothing(void) {
    const canopen_axis before = on.axes[0];
    each_wrong_request_has_its_abort_code();
    canopen_axis after = on.axes[0];
    memcpy(after.sdo_answer, before.sdo_answer, sizeof after.sdo_answer);
    after.sdo_index = before.sdo_index;
    after.sdo_sub = before.sdo_sub;
    after.sdo_row = before.sdo_row;
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&before, &after, sizeof before);
}

/* --- frames of transfers ----------------------------------------------------------------------------------------- */

static void expect(const uint8_t sent[8], const uint8_t wanted[8]) {
    const uint8_t *answer = request(sent);
    TEST_ASSERT_NOT_NULL(answer);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted, answer, 8);
}

#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})
#define ABORT(index, sub, code) \
    BYTES(0x80, (index) & 0xFF, (index) >> 8, sub, (code) & 0xFF, (code) >> 8 & 0xFF, (code) >> 16 & 0xFF, (code) >> 24)

static void expedited_transfers_have_the_size_of_the_object(void) {
    expect(BYTES(0x40, 0x00, 0x10, 0), BYTES(0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00));
    expect(BYTES(0x40, 0x61, 0x60, 0), BYTES(0x4F, 0x61, 0x60, 0));
    expect(BYTES(0x2B, 0x40, 0x60, 0, 0x06, 0x00), BYTES(0x60, 0x40, 0x60, 0));
    expect(BYTES(0x22, 0x40, 0x60, 0, 0x07, 0x00, 9, 9), BYTES(0x60, 0x40, 0x60, 0)); /* size not given */
    TEST_ASSERT_EQUAL_HEX16(SWITCHED_ON, state());
}

static void a_text_is_uploaded_in_segments(void) {
    char text[64] = {0};
    const uint8_t *answer = request(BYTES(0x40, 0x08, 0x10, 0));
    const uint32_t length = canopen_get(answer + 4, 4);
    TEST_ASSERT_EQUAL_HEX8(0x41, answer[0]);
    uint32_t got = 0;
    for (uint8_t toggle = 0; got < length; toggle ^= 16) {
        answer = request(BYTES((uint8_t)(0x60 | toggle)));
        TEST_ASSERT_EQUAL_HEX8(toggle, answer[0] & 0xF0);
        const uint32_t count = 7U - (answer[0] >> 1 & 7U);
        memcpy(text + got, answer + 1, count);
        got += count;
        TEST_ASSERT_EQUAL(got == length, answer[0] & 1);
    }
    TEST_ASSERT_EQUAL_STRING("Laconic drive", text);
    expect(BYTES(0x60), ABORT(0x1008, 0, CANOPEN_COMMAND)); /* it is over */
}

static void a_number_is_downloaded_in_segments(void) {
    expect(BYTES(0x21, 0xFF, 0x60, 0, 4), BYTES(0x60, 0xFF, 0x60, 0));
    expect(BYTES(0x08, 0x11, 0x22, 0x33), BYTES(0x20)); /* three bytes, more follow */
    expect(BYTES(0x1D, 0x44), BYTES(0x30));             /* one byte, the last */
    TEST_ASSERT_EQUAL_HEX32(0x44332211, get(0x60FF, 0));
    expect(BYTES(0x20, 0xFF, 0x60, 0), BYTES(0x60, 0xFF, 0x60, 0)); /* size not given */
    expect(BYTES(0x07, 1, 2, 3, 4), BYTES(0x20));
    TEST_ASSERT_EQUAL_HEX32(0x04030201, get(0x60FF, 0));
}

static void wrong_segments_end_the_transfer(void) {
    expect(BYTES(0x00), ABORT(0, 0, CANOPEN_COMMAND)); /* none began */
    expect(BYTES(0x21, 0xFF, 0x60, 0, 4), BYTES(0x60, 0xFF, 0x60, 0));
    expect(BYTES(0x17, 1, 2, 3, 4), ABORT(0x60FF, 0, CANOPEN_TOGGLE));
    expect(BYTES(0x07, 1, 2, 3, 4), ABORT(0x60FF, 0, CANOPEN_COMMAND));
    expect(BYTES(0x21, 0xFF, 0x60, 0, 4), BYTES(0x60, 0xFF, 0x60, 0));
    expect(BYTES(0x05, 1, 2, 3, 4, 5), ABORT(0x60FF, 0, CANOPEN_TOO_LONG));
    expect(BYTES(0x20, 0xFF, 0x60, 0), BYTES(0x60, 0xFF, 0x60, 0));
    expect(BYTES(0x09, 1, 2, 3), ABORT(0x60FF, 0, CANOPEN_TOO_SHORT));
    expect(BYTES(0x21, 0xFF, 0x60, 0, 5), ABORT(0x60FF, 0, CANOPEN_TOO_LONG));
    expect(BYTES(0x21, 0xFF, 0x60, 0, 3), ABORT(0x60FF, 0, CANOPEN_TOO_SHORT));
    expect(BYTES(0x21, 0x60, 0x60, 0, 1), BYTES(0x60, 0x60, 0x60, 0));
    expect(BYTES(0x0D, 6), ABORT(0x6060, 0, CANOPEN_VALUE)); /* homing */
    expect(BYTES(0x40, 0x08, 0x10, 0), BYTES(0x41, 0x08, 0x10, 0, 13));
    expect(BYTES(0x70), ABORT(0x1008, 0, CANOPEN_TOGGLE));
    expect(BYTES(0x40, 0x08, 0x10, 0), BYTES(0x41, 0x08, 0x10, 0, 13));
    expect(BYTES(0x00), ABORT(0x1008, 0, CANOPEN_COMMAND)); /* a download's segment */
    TEST_ASSERT_EQUAL(0, get(0x60FF, 0));
}

static void block_transfers_and_unknown_commands_are_refused(void) {
    static const uint8_t commands[4] = {0xA0, 0xC2, 0xE0, 0xFF};
    for (int k = 0; k < 4; k++) {
        const uint8_t *answer = request(BYTES(commands[k], 0x08, 0x10, 0));
        TEST_ASSERT_EQUAL_HEX8(0x80, answer[0]);
        TEST_ASSERT_EQUAL_HEX32(CANOPEN_COMMAND, canopen_get(answer + 4, 4));
    }
}

static void an_abort_of_the_client_ends_a_transfer_without_an_answer(void) {
    expect(BYTES(0x21, 0xFF, 0x60, 0, 4), BYTES(0x60, 0xFF, 0x60, 0));
    TEST_ASSERT_NULL(request(BYTES(0x80, 0xFF, 0x60, 0)));
    expect(BYTES(0x07, 1, 2, 3, 4), ABORT(0x60FF, 0, CANOPEN_COMMAND));
}

static void requests_that_are_no_sdo_and_those_for_others_are_passed_over(void) {
    forget();
    deliver(0x600 + ID, BYTES(0x40, 0x00, 0x10, 0), 7);
    deliver(0x600 + 44, BYTES(0x40, 0x00, 0x10, 0), 8);
    laconic_frame frame = {.id = 0x600 + ID, .length = 8, .extended = true};
    laconic_canopen.on_frame(&on.drives, &frame, 0);
    frame.extended = false;
    frame.remote = true;
    laconic_canopen.on_frame(&on.drives, &frame, 0);
    collect();
    TEST_ASSERT_EQUAL(0, on.count);
    deliver(0x600 + OTHER_ID, BYTES(0x40, 0x00, 0x10, 0), 8);
    TEST_ASSERT_EQUAL_HEX32(0x580 + OTHER_ID, on.sent[0].id);
}

static void what_the_drive_is_may_be_written_as_it_is(void) {
    set(0x608F, 1, COUNTS);
    set(0x608F, 2, 1);
    set(0x6091, 1, 1);
    set(0x6092, 1, COUNTS);
    set(0x6086, 0, 0);
    set(0x6075, 0, 10000);
    set(0x6076, 0, 1000);
    set(0x60A8, 0, 0x00B50000);
    set(0x60A9, 0, 0x00B50300);
    set(0x60AA, 0, 0x00B55700);
}

static void homing_is_refused_by_every_way(void) {
    set(0x6060, 0, 9);
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_VALUE, write_as(0x6060, 0, 6, 1));
    start_nodes();
    deliver(0x200 + ID, BYTES(0, 0, 6), 3);
    TEST_ASSERT_EQUAL(9, get(0x6061, 0));
    TEST_ASSERT_BITS_LOW(32, get(0x6502, 0));
}

static void identifiers_are_those_of_the_predefined_connections(void) {
    TEST_ASSERT_EQUAL_HEX32(0x80, get(0x1005, 0));
    TEST_ASSERT_EQUAL_HEX32(0x80 + ID, get(0x1014, 0));
    TEST_ASSERT_EQUAL_HEX32(0x600 + ID, get(0x1200, 1));
    TEST_ASSERT_EQUAL_HEX32(0x580 + ID, get(0x1200, 2));
    TEST_ASSERT_EQUAL(ID, get(0x1018, 4));
    TEST_ASSERT_EQUAL(24000, get(0x6079, 0)); /* mV */
}

/* CiA 301 reserves 0 to 0x7F, 0x101 to 0x180, 0x581 to 0x5FF, 0x601 to 0x67F and those from 0x6E0 on. */
static void reserved_identifiers_are_refused_at_each_end_of_their_ranges(void) {
    static const struct {
        uint16_t id;
        bool is_free;
    } ends[] = {{0x000, false}, {0x001, false}, {0x07F, false}, {0x080, true},  {0x100, true},  {0x101, false},
                {0x180, false}, {0x181, true},  {0x580, true},  {0x581, false}, {0x5FF, false}, {0x600, true},
                {0x601, false}, {0x67F, false}, {0x680, true},  {0x6DF, true},  {0x6E0, false}, {0x7FF, false}};
    for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++) {
        TEST_ASSERT_EQUAL_HEX32(0, write_as(0x1402, 1, 0x80000400U + ID, 4));
        const uint32_t refusal = write_as(0x1402, 1, ends[k].id, 4);
        TEST_ASSERT_EQUAL_HEX32(ends[k].is_free ? 0 : CANOPEN_VALUE, refusal);
        if (refusal == 0) TEST_ASSERT_EQUAL_HEX32(ends[k].id, get(0x1402, 1));
        if (refusal == 0) set(0x1402, 1, (int64_t)(0x80000000U | ends[k].id));
        if (refusal == 0) set(0x1402, 1, (int64_t)(0x80000400U + ID));
    }
}

static void another_identifier_of_sync_is_heard_instead_of_the_usual_one(void) {
    set(0x1005, 0, 0x81);
    TEST_ASSERT_EQUAL_HEX32(0x81, get(0x1005, 0));
    start_nodes();
    forget();
    sync();
    TEST_ASSERT_EQUAL(0, count_of(0x280 + ID));
    deliver(0x81, "", 0);
    TEST_ASSERT_EQUAL(1, count_of(0x280 + ID));
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_VALUE, write_as(0x1005, 0, 0x40000080, 4)); /* it is no producer */
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_VALUE, write_as(0x1014, 0, 0x40000080U + ID, 4));
}

static void limits_hold_at_each_end(void) {
    static const struct {
        uint16_t index;
        uint8_t sub;
        int64_t low, high;
        uint32_t below, above; /* 0: there is nothing beyond */
    } limits[] = {{0x1029, 1, 0, 2, 0, CANOPEN_TOO_HIGH},
                  {0x6007, 0, 0, 3, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x605A, 0, 0, 6, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x605B, 0, 0, 1, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x605C, 0, 0, 1, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x605D, 0, 1, 2, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x605E, 0, 0, 2, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH},
                  {0x6072, 0, 0, 1000, 0, CANOPEN_TOO_HIGH},
                  {0x6083, 0, 1, 0xFFFFFFFFLL, CANOPEN_TOO_LOW, 0},
                  {0x6084, 0, 1, 0xFFFFFFFFLL, CANOPEN_TOO_LOW, 0},
                  {0x6085, 0, 1, 0xFFFFFFFFLL, CANOPEN_TOO_LOW, 0},
                  {0x60C2, 1, 1, 255, CANOPEN_TOO_LOW, 0},
                  {0x60C2, 2, -6, 0, CANOPEN_TOO_LOW, CANOPEN_TOO_HIGH}};
    for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++) {
        const uint16_t index = limits[k].index;
        const uint8_t sub = limits[k].sub, size = size_of(index, sub);
        set(index, sub, limits[k].low);
        set(index, sub, limits[k].high);
        if (limits[k].below != 0)
            TEST_ASSERT_EQUAL_HEX32(limits[k].below, write_as(index, sub, (uint32_t)(limits[k].low - 1), size));
        if (limits[k].above != 0)
            TEST_ASSERT_EQUAL_HEX32(limits[k].above, write_as(index, sub, (uint32_t)(limits[k].high + 1), size));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(each_wrong_request_has_its_abort_code);
    RUN_TEST(a_refused_request_changes_nothing);
    RUN_TEST(expedited_transfers_have_the_size_of_the_object);
    RUN_TEST(a_text_is_uploaded_in_segments);
    RUN_TEST(a_number_is_downloaded_in_segments);
    RUN_TEST(wrong_segments_end_the_transfer);
    RUN_TEST(block_transfers_and_unknown_commands_are_refused);
    RUN_TEST(an_abort_of_the_client_ends_a_transfer_without_an_answer);
    RUN_TEST(requests_that_are_no_sdo_and_those_for_others_are_passed_over);
    RUN_TEST(what_the_drive_is_may_be_written_as_it_is);
    RUN_TEST(homing_is_refused_by_every_way);
    RUN_TEST(identifiers_are_those_of_the_predefined_connections);
    RUN_TEST(reserved_identifiers_are_refused_at_each_end_of_their_ranges);
    RUN_TEST(another_identifier_of_sync_is_heard_instead_of_the_usual_one);
    RUN_TEST(limits_hold_at_each_end);
    return UNITY_END();
}
