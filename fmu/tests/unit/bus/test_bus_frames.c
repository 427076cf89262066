/* Tests of bus/model.c beside its usual way: what is told once, what decides between settings, and that the bus takes
 * nothing for a frame that is none. */
#include "bus_bench.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

/* ISO 11898-1: an error-passive node sends its frames of CAN FD with ESI recessive, and receivers see it. */
static void what_a_sender_says_of_its_errors_arrives_with_its_frame(void) {
    const laconic_frame frame = {.id = 1, .length = 8, .fd = true};
    begin();
    ls_bus_put_frame(&out, &frame, true);
    ls_bus_put_frame(&out, &frame, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_FD_TRANSMIT, first_of("Node2"));
    TEST_ASSERT_TRUE(told.error_passive);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_FD_TRANSMIT, next());
    TEST_ASSERT_FALSE(told.error_passive);
}

static void each_setting_of_a_node_leaves_its_others(void) {
    begin();
    ls_bus_put_configuration(&out, LS_BUS_ARBITRATION_LOST_BEHAVIOR, LS_BUS_DISCARD_AND_NOTIFY);
    ls_bus_put_configuration(&out, LS_BUS_CAN_BAUDRATE, 1000000);
    ls_bus_put_configuration(&out, LS_BUS_CAN_FD_BAUDRATE, 2000000);
    ls_bus_put_configuration(&out, LS_BUS_CAN_XL_BAUDRATE, 9000000);
    put(0x11, false, false);
    send("Node2");
    put(0x10, false, false);
    send("Node1");
    update();
    const bus_node *node = &instance()->model.node[1];
    TEST_ASSERT_TRUE(node->discards && node->bit_rate_bit_per_s == 1000000 && node->fd_bit_rate_bit_per_s == 2000000);
    step(0, 1e-3);
    TEST_ASSERT_EQUAL(LS_BUS_ARBITRATION_LOST, first_of("Node2"));
}

static void nodes_begin_error_active(void) {
    begin();
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++)
        TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, instance()->model.node[k].status);
}

/* Whatever a node has said of frames that lose arbitration. */
static void an_event_without_new_bytes_brings_nothing(void) {
    const laconic_frame empty = {.id = 0x10};
    begin();
    ls_bus_put_configuration(&out, LS_BUS_ARBITRATION_LOST_BEHAVIOR, LS_BUS_DISCARD_AND_NOTIFY);
    ls_bus_put_frame(&out, &empty, false);
    ls_bus_put_frame(&out, &empty, false);
    send("Node1");
    for (int n = 0; n < 8; n++) TEST_ASSERT_FALSE(update());
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 0 && get_integer("lost_arbitrations") == 0);
    TEST_ASSERT_TRUE(get_real("busy_s", 0) == 0 && instance()->model.node[0].queue.size == 2 * 16);
    step(0, 1e-3);
    TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_carried"));
}

/* A frame of CAN FD may carry anything, also what would be a frame of its own on the way to a bus. */
static void data_of_a_frame_are_no_frame(void) {
    const laconic_frame frame = {.id = 0x20, .length = 32, .fd = true, .data = {1, [7] = 0x10, [11] = 16}};
    begin();
    ls_bus_put_frame(&out, &frame, false);
    put(0x21, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_carried"));
}

static void a_frame_ends_at_its_end_to_a_few_picoseconds(void) {
    begin();
    put(0x10, false, false);
    send("Node1");
    update();
    step(0, ONE_S - 5e-12);
    TEST_ASSERT_EQUAL_INT32(0, get_integer("frames_carried"));
    step(ONE_S - 5e-12, 4.5e-12);
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
    put(0x10, false, false);
    send("Node1");
    update();
    step(ONE_S, 0);
    const double free_s = instance()->model.free_s;
    double end_s = free_s - 1e-12; /* just so much before it */
    while (end_s + 1e-12 > free_s) end_s = nextafter(end_s, 0);
    while (end_s + 1e-12 < free_s) end_s = nextafter(end_s, 1);
    TEST_ASSERT_TRUE(end_s + 1e-12 == free_s);
    fmu_model_advance(instance(), end_s);
    TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_carried"));
}

static void the_first_frame_that_is_lost_is_told(void) {
    begin();
    while (ls_bus_has_room(&out, 17)) put(0x10, false, false);
    send("Node2");
    update();
    log_clear();
    put(0x10, false, false);
    send("Node2");
    update();
    ASSERT_LOGGED("logStatusWarning: Node2 sends more than the bus can carry: frames are lost");
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_dropped"));
    put(0x10, false, false);
    send("Node2");
    update();
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_dropped"));
}

/* As slow as it may be. */
static void one_bit_per_second_is_a_rate_of_can_fd(void) {
    const laconic_frame frame = {.id = 1, .length = 8, .fd = true, .bit_rate_switch = true};
    begin();
    ls_bus_put_configuration(&out, LS_BUS_CAN_FD_BAUDRATE, 1);
    ls_bus_put_frame(&out, &frame, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, frame_time_s(&frame, 1000000, 1), get_real("busy_s", 0));
    TEST_ASSERT_TRUE(get_real("busy_s", 0) > 90);
}

static void one_bit_per_second_is_a_rate(void) {
    bool known;
    begin();
    ls_bus_put_configuration(&out, LS_BUS_CAN_BAUDRATE, 1);
    put(0x10, false, false);
    send("Node1");
    update();
    TEST_ASSERT_TRUE(countdown("Node2", &known) == 55 && known);
}

static void of_each_three_frames_the_third_fails(void) {
    static const uint32_t codes[6] = {LS_BUS_CONFIRM, LS_BUS_CONFIRM, LS_BUS_BUS_ERROR,
                                      LS_BUS_CONFIRM, LS_BUS_CONFIRM, LS_BUS_BUS_ERROR};
    set_integer("error_every", 3);
    begin();
    for (uint32_t k = 0; k < 6; k++) put(0x30 + k, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    take("Node1");
    told_to = 0;
    for (uint32_t k = 0; k < 6; k++) {
        TEST_ASSERT_EQUAL(codes[k], next());
        TEST_ASSERT_EQUAL_HEX32(0x30 + k, told.id);
    }
}

/* When both have heard of it nothing is left to be sent. */
static void an_error_is_told_to_both_nodes_and_to_no_other(void) {
    bool known, needed = true;
    set_integer("error_every", 1);
    begin();
    put(0x30, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_EQUAL(LS_BUS_BUS_ERROR, first_of("Node1"));
    TEST_ASSERT_EQUAL(LS_BUS_BUS_ERROR, first_of("Node2"));
    countdown("Node1", &known);
    TEST_ASSERT_FALSE(known);
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, 1e-3, 1e-3, true, &needed, NULL, NULL, NULL));
    TEST_ASSERT_FALSE(needed);
}

/* Behind the last number frames are counted from 1. */
static void behind_the_last_number_a_first_frame_is_carried(void) {
    fmu_model *model = one_frame_near_the_last_number(2);
    TEST_ASSERT_TRUE(model->carried == INT32_MAX - 4 && model->failed == 5);
}

/* Each terminal's own. */
static void what_is_ready_for_one_node_is_sent_soon(void) {
    bool known;
    for (int first = 0; first < 2; first++) {
        make();
        begin();
        put(0x10, false, false);
        send("Node1");
        update();
        step(0, 1e-3);
        take(first ? "Node2" : "Node1"); /* the other one's is left */
        TEST_ASSERT_TRUE(countdown("Node1", &known) == 1e-6 && known);
        take(first ? "Node1" : "Node2");
        countdown("Node1", &known);
        TEST_ASSERT_FALSE(known);
    }
}

/* The glue asks each model, also for what it refuses before: bytes of a state, and parameters that are tuned. */
static void of_its_own_it_writes_and_changes_nothing(void) {
    fmu_stream stream = {0};
    TEST_ASSERT_TRUE(fmu_model_serialize(&stream, &instance()->model) && stream.at == 0);
    instance()->model.change_needed = true;
    OK(fmu_model_change(instance()));
    TEST_ASSERT_FALSE(instance()->model.change_needed);
    stream.failed = true;
    TEST_ASSERT_FALSE(fmu_model_serialize(&stream, &instance()->model));
}

static void counts_have_no_value_before_initialization(void) {
    static const char *const names[] = {"frames_carried", "lost_arbitrations", "frames_failed", "frames_dropped"};
    double seconds = 7;
    int32_t number = 7;
    for (size_t k = 0; k < 4; k++) {
        const fmi3ValueReference count = ref(names[k], 0);
        ASSERT_REFUSED(fmi3GetInt32(c, &count, 1, &number, 1), "it has no value before initialization");
    }
    const fmi3ValueReference busy = ref("busy_s", 0);
    ASSERT_REFUSED(fmi3GetFloat64(c, &busy, 1, &seconds, 1), "it has no value before initialization");
    TEST_ASSERT_TRUE(number == 7 && seconds == 7);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_a_sender_says_of_its_errors_arrives_with_its_frame);
    RUN_TEST(each_setting_of_a_node_leaves_its_others);
    RUN_TEST(nodes_begin_error_active);
    RUN_TEST(an_event_without_new_bytes_brings_nothing);
    RUN_TEST(data_of_a_frame_are_no_frame);
    RUN_TEST(a_frame_ends_at_its_end_to_a_few_picoseconds);
    RUN_TEST(the_first_frame_that_is_lost_is_told);
    RUN_TEST(one_bit_per_second_is_a_rate_of_can_fd);
    RUN_TEST(one_bit_per_second_is_a_rate);
    RUN_TEST(of_each_three_frames_the_third_fails);
    RUN_TEST(an_error_is_told_to_both_nodes_and_to_no_other);
    RUN_TEST(behind_the_last_number_a_first_frame_is_carried);
    RUN_TEST(what_is_ready_for_one_node_is_sent_soon);
    RUN_TEST(of_its_own_it_writes_and_changes_nothing);
    RUN_TEST(counts_have_no_value_before_initialization);
    return UNITY_END();
}
