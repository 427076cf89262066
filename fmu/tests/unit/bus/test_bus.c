/* Tests of bus/model.c: frames take their time and go in the order of their identifiers, errors and lost
 * arbitration are told, and what cannot be carried is counted. */
#include "bus_bench.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

static void a_frame_arrives_after_its_time_and_is_confirmed(void) {
    begin();
    put(0x10, false, false);
    send("Node1");
    update();
    TEST_ASSERT_EQUAL(0, first_of("Node2"));
    step(0, ONE_S - 1e-9);
    TEST_ASSERT_EQUAL(0, first_of("Node2"));
    TEST_ASSERT_EQUAL(0, first_of("Node1"));
    step(ONE_S - 1e-9, 1e-9);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node2"));
    TEST_ASSERT_TRUE(told.frame.id == 0x10 && told.frame.length == 1 && told.frame.data[0] == 9);
    TEST_ASSERT_EQUAL(LS_BUS_CONFIRM, first_of("Node1"));
    TEST_ASSERT_EQUAL_HEX32(0x10, told.id);
    TEST_ASSERT_EQUAL(0, next());
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, ONE_S, get_real("busy_s", 0));
}

/* What the second node sends is the first one's; several frames follow each other without a gap. */
static void frames_follow_each_other_in_either_direction(void) {
    begin();
    for (uint32_t k = 0; k < 3; k++) put(0x20 + k, false, false);
    send("Node2");
    update();
    step(0, 2 * ONE_S + 1e-9);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node1"));
    TEST_ASSERT_EQUAL_HEX32(0x20, told.id);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    TEST_ASSERT_EQUAL_HEX32(0x21, told.id);
    TEST_ASSERT_EQUAL(0, next());
    step(2 * ONE_S + 1e-9, ONE_S);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node1"));
    TEST_ASSERT_EQUAL_HEX32(0x22, told.id);
    TEST_ASSERT_EQUAL_INT32(3, get_integer("frames_carried"));
    TEST_ASSERT_EQUAL_INT32(0, get_integer("lost_arbitrations"));
}

/* The frames of two nodes at once, in the order in which the bus carries them; each pair from either side. */
static void wins(uint32_t first, bool first_extended, bool first_remote, uint32_t second, bool extended, bool remote) {
    for (int turned = 0; turned < 2; turned++) {
        make();
        begin();
        put(first, first_extended, first_remote);
        send(turned ? "Node2" : "Node1");
        put(second, extended, remote);
        send(turned ? "Node1" : "Node2");
        update();
        step(0, 47e-6);
        step(47e-6, 20e-6);
        step(67e-6, 10e-6); /* the first of them has passed, whichever it is */
        TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
        TEST_ASSERT_EQUAL_INT32(1, get_integer("lost_arbitrations"));
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of(turned ? "Node1" : "Node2"));
        TEST_ASSERT_TRUE(told.id == first && told.frame.extended == first_extended);
        step(77e-6, 1e-3);
        TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_carried"));
    }
}

static void the_lower_number_wins_bit_by_bit(void) {
    wins(0x10, false, false, 0x11, false, false);
    wins(0x10, false, false, 0x10, false, true);       /* data before remote */
    wins(0x10, false, true, 0x10U << 18, true, false); /* RTR before IDE */
    wins(0x10, false, false, 0x10U << 18, true, false);
    wins(0x0FU << 18, true, false, 0x10, false, false);
    wins(0x10U << 18 | 1, true, false, 0x10U << 18 | 2, true, false);
    wins(0x10U << 18 | 2, true, false, 0x10U << 18 | 3, true, false);
    wins(0x10U << 18 | 0x1FFFF, true, false, 0x10U << 18 | 0x20000, true, false);
    wins(0x10U << 18 | 1, true, false, 0x10U << 18 | 1, true, true);
    wins(0x10U << 18 | 0x3FFFF, true, true, 0x11U << 18, true, false);
}

/* What no bus could arbitrate: the first node's frame goes first. */
static void the_same_frame_of_both_nodes_goes_by_their_order(void) {
    for (int turned = 0; turned < 2; turned++) {
        make();
        begin();
        put(0x10, false, false);
        give(turned ? "Node2" : "Node1", &out);
        give(turned ? "Node1" : "Node2", &out);
        out.size = 0;
        update();
        step(0, 60e-6);
        TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node2"));
        TEST_ASSERT_EQUAL(LS_BUS_CONFIRM, first_of("Node1"));
    }
}

static void who_discards_is_told_of_lost_arbitration(void) {
    begin();
    put(0x10, false, false);
    send("Node1");
    ls_bus_put_configuration(&out, LS_BUS_ARBITRATION_LOST_BEHAVIOR, LS_BUS_DISCARD_AND_NOTIFY);
    put(0x11, false, false);
    send("Node2");
    update();
    step(0, 1e-3);
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 1 && get_integer("lost_arbitrations") == 1);
    TEST_ASSERT_EQUAL(LS_BUS_ARBITRATION_LOST, first_of("Node2"));
    TEST_ASSERT_EQUAL_HEX32(0x11, told.id);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    ls_bus_put_configuration(&out, LS_BUS_ARBITRATION_LOST_BEHAVIOR, LS_BUS_BUFFER_AND_RETRANSMIT);
    put(0x12, false, false);
    send("Node2");
    put(0x10, false, false);
    send("Node1");
    update();
    step(1e-3, 1e-3);
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 3 && get_integer("lost_arbitrations") == 2);
}

static void a_passive_node_goes_behind_an_active_one(void) {
    begin();
    ls_bus_put_status(&out, LS_BUS_ERROR_PASSIVE);
    put(0x10, false, false);
    send("Node1");
    put(0x11, false, false);
    send("Node2");
    update();
    step(0, ONE_S + 1e-9);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node1"));
    TEST_ASSERT_EQUAL_HEX32(0x11, told.id);
}

static void a_node_that_is_off_neither_sends_nor_hears(void) {
    begin();
    ls_bus_put_status(&out, LS_BUS_BUS_OFF);
    put(0x10, false, false);
    send("Node1");
    put(0x11, false, false);
    send("Node2");
    update();
    step(0, 1e-3);
    TEST_ASSERT_EQUAL(0, first_of("Node1"));
    TEST_ASSERT_EQUAL(0, first_of("Node2")); /* nobody acknowledges it */
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
}

static void bit_rates_are_those_that_the_nodes_agree_on(void) {
    static const struct {
        uint32_t first, second;
        double rate;
    } cases[] = {{0, 0, 250e3}, {500000, 0, 500e3}, {0, 125000, 125e3}, {100000, 100000, 100e3}, {100000, 200000, 0}};
    for (size_t k = 0; k < 5; k++) {
        make();
        set_integer("bit_rate_bit_per_s", 250000);
        begin();
        if (cases[k].first) ls_bus_put_configuration(&out, LS_BUS_CAN_BAUDRATE, cases[k].first);
        put(0x10, false, false);
        send("Node1");
        if (cases[k].second) ls_bus_put_configuration(&out, LS_BUS_CAN_BAUDRATE, cases[k].second);
        send("Node2");
        update();
        log_clear();
        for (int n = 0; n < 3; n++) {
            step(0.1 * n, 0.1);
            TEST_ASSERT_EQUAL_INT(cases[k].rate > 0 ? 0 : 1, lines); /* with the first frame, and once */
        }
        TEST_ASSERT_EQUAL_INT32(cases[k].rate > 0, get_integer("frames_carried"));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, cases[k].rate > 0 ? 55 / cases[k].rate : 0, get_real("busy_s", 0));
    }
    ASSERT_LOGGED("logStatusWarning: Node1 works at 100000 bit/s, Node2 at 200000: the bus carries nothing");
    bool known;
    countdown("Node1", &known);
    TEST_ASSERT_FALSE(known);
}

static void the_faster_part_of_can_fd_has_the_higher_rate(void) {
    const laconic_frame frame = {.id = 1, .length = 8, .fd = true, .bit_rate_switch = true};
    for (int k = 0; k < 3; k++) {
        make();
        begin();
        if (k > 0) ls_bus_put_configuration(&out, LS_BUS_CAN_FD_BAUDRATE, 2000000);
        ls_bus_put_frame(&out, &frame, false);
        send("Node1");
        ls_bus_put_configuration(&out, LS_BUS_CAN_XL_BAUDRATE, 9000000); /* another bus */
        if (k > 1) ls_bus_put_configuration(&out, LS_BUS_CAN_FD_BAUDRATE, 5000000);
        send("Node2");
        update();
        step(0, 1e-3);
        const uint32_t rates[3] = {1000000, 2000000, 5000000};
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, frame_time_s(&frame, 1000000, rates[k]), get_real("busy_s", 0));
    }
}

static void each_so_many_frames_one_fails(void) {
    set_integer("error_every", 3);
    begin();
    for (uint32_t k = 0; k < 9; k++) put(0x30 + k, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 6 && get_integer("frames_failed") == 3);
    make();
    set_integer("error_every", 2);
    begin();
    for (uint32_t k = 0; k < 5; k++) put(0x30 + k, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 3 && get_integer("frames_failed") == 2);
    const uint32_t first[5] = {LS_BUS_CONFIRM, LS_BUS_BUS_ERROR, LS_BUS_CONFIRM, LS_BUS_BUS_ERROR, LS_BUS_CONFIRM};
    take("Node1");
    told_to = 0;
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL(first[k], next());
        if (k == 1) TEST_ASSERT_TRUE(told.is_sender && told.flag == LS_BUS_SECONDARY_ERROR_FLAG && told.error == 4);
    }
    take("Node2");
    told_to = 0;
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL(k % 2 ? LS_BUS_BUS_ERROR : LS_BUS_CAN_TRANSMIT, next());
        if (k == 1) TEST_ASSERT_TRUE(!told.is_sender && told.flag == LS_BUS_PRIMARY_ERROR_FLAG && told.id == 0x31);
    }
}

static void a_sum_of_frames_has_its_end(void) {
    fmu_model *model = one_frame_near_the_last_number(1);
    TEST_ASSERT_EQUAL_INT32(6, model->failed);
    model->failed = INT32_MAX;
    put(0x30, false, false);
    send("Node1");
    update();
    step(1e-3, 1e-3);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, model->failed);
}

static void more_than_the_bus_can_carry_is_counted_and_told_once(void) {
    begin();
    log_clear();
    for (int round = 0; round < 2; round++) {
        while (ls_bus_has_room(&out, 17)) put(0x10, false, false);
        send("Node2");
        update();
    }
    ASSERT_LOGGED("logStatusWarning: Node2 sends more than the bus can carry: frames are lost");
    TEST_ASSERT_EQUAL_INT(1, lines);
    const int32_t held = LS_BUS_BUFFER_BYTES / 17;
    TEST_ASSERT_EQUAL_INT32(held, get_integer("frames_dropped"));
    step(0, 2); /* and nobody takes what was carried */
    TEST_ASSERT_EQUAL_INT32(held, get_integer("frames_carried"));
    TEST_ASSERT_EQUAL_INT32(held, get_integer("frames_dropped"));
    put(0x11, false, false);
    send("Node2");
    update();
    step(2, 1e-3);
    TEST_ASSERT_EQUAL_INT32(held + 1, get_integer("frames_dropped"));
}

static void wrong_operations_are_answered_but_for_wrong_answers(void) {
    const uint8_t wrong[9] = {0x99, 0, 0, 0, 9, 0, 0, 0, 1}, answer[9] = {0x01, 0, 0, 0, 9, 0, 0, 0, 1};
    begin();
    memcpy(out.bytes, wrong, 9);
    memcpy(out.bytes + 9, answer, 9);
    out.size = 18;
    ls_bus_put_id(&out, LS_BUS_CONFIRM, 1); /* not for a bus */
    send("Node1");
    update();
    TEST_ASSERT_EQUAL(LS_BUS_FORMAT_ERROR, first_of("Node1"));
    TEST_ASSERT_EQUAL_size_t(19, told.size);
    TEST_ASSERT_EQUAL(0, next());
    TEST_ASSERT_EQUAL(0, first_of("Node2"));
}

static void it_has_no_start_values_of_its_own(void) {
    TEST_ASSERT_FALSE(fmu_model_take_private(instance(), FMU_PRIVATE_START, 1));
}

/* A bus that has started anew has nothing of before. */
static void a_reset_empties_the_bus(void) {
    begin();
    ls_bus_put_configuration(&out, LS_BUS_CAN_BAUDRATE, 1000000);
    put(0x10, false, false);
    put(0x11, false, false);
    send("Node1");
    update();
    TEST_ASSERT_EQUAL_UINT32(0, instance()->model.node[0].fd_bit_rate_bit_per_s);
    step(0, ONE_S * 1.5);
    fmu_model *model = &instance()->model;
    model->start_needed = true; /* another start, without a reset */
    model->carried = model->contended = model->failed = model->dropped = 7;
    model->rates_differ = true;
    TEST_ASSERT_TRUE(!update() && instance()->model.node[0].queue.size == 0 && instance()->model.busy_s == 0);
    TEST_ASSERT_EQUAL_UINT32(0, instance()->model.node[0].bit_rate_bit_per_s);
    TEST_ASSERT_TRUE(!model->is_busy && !model->rates_differ && model->carried == 0 && model->contended == 0);
    TEST_ASSERT_TRUE(model->failed == 0 && model->dropped == 0 && !model->start_needed && !model->change_needed);
    OK(fmi3Reset(c));
    begin();
    TEST_ASSERT_TRUE(get_integer("frames_carried") == 0 && get_real("busy_s", 0) == 0);
    step(0, 1);
    TEST_ASSERT_EQUAL(0, first_of("Node2"));
    TEST_ASSERT_EQUAL_INT32(0, get_integer("frames_carried"));
}

/* Until the frame on the bus ends; soon where operations are ready; not known where there is nothing to do. */
static void a_countdown_says_when_something_will_be_sent(void) {
    bool known;
    begin();
    countdown("Node1", &known);
    TEST_ASSERT_FALSE(known);
    put(0x10, false, false);
    put(0x11, false, false);
    send("Node1");
    update();
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, ONE_S, countdown("Node2", &known)); /* as soon as time passes */
    TEST_ASSERT_TRUE(known);
    step(0, 20e-6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, ONE_S - 20e-6, countdown("Node2", &known));
    step(20e-6, ONE_S - 20e-6);
    TEST_ASSERT_TRUE(countdown("Node2", &known) == 1e-6 && known); /* it can be sent */
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("Node2"));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIRM, first_of("Node1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, ONE_S, countdown("Node2", &known));
    step(ONE_S, ONE_S - 0.5e-6);
    TEST_ASSERT_TRUE(countdown("Node2", &known) == 1e-6 && known); /* no shorter than the resolution */
}

static void parameters_are_set_before_the_run_and_the_bus_says_that_it_notifies(void) {
    const fmi3ValueReference notifies = ref("Node1.BusNotifications", 0), rate = ref("bit_rate_bit_per_s", 0);
    const int32_t slow = 1000;
    bool flag = false;
    begin();
    OK(fmi3GetBoolean(c, &notifies, 1, &flag, 1));
    TEST_ASSERT_TRUE(flag);
    ASSERT_REFUSED(fmi3SetInt32(c, &rate, 1, &slow, 1), "it is fixed once initialization has ended");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_frame_arrives_after_its_time_and_is_confirmed);
    RUN_TEST(frames_follow_each_other_in_either_direction);
    RUN_TEST(the_lower_number_wins_bit_by_bit);
    RUN_TEST(the_same_frame_of_both_nodes_goes_by_their_order);
    RUN_TEST(who_discards_is_told_of_lost_arbitration);
    RUN_TEST(a_passive_node_goes_behind_an_active_one);
    RUN_TEST(a_node_that_is_off_neither_sends_nor_hears);
    RUN_TEST(bit_rates_are_those_that_the_nodes_agree_on);
    RUN_TEST(the_faster_part_of_can_fd_has_the_higher_rate);
    RUN_TEST(each_so_many_frames_one_fails);
    RUN_TEST(a_sum_of_frames_has_its_end);
    RUN_TEST(more_than_the_bus_can_carry_is_counted_and_told_once);
    RUN_TEST(wrong_operations_are_answered_but_for_wrong_answers);
    RUN_TEST(it_has_no_start_values_of_its_own);
    RUN_TEST(a_reset_empties_the_bus);
    RUN_TEST(a_countdown_says_when_something_will_be_sent);
    RUN_TEST(parameters_are_set_before_the_run_and_the_bus_says_that_it_notifies);
    return UNITY_END();
}
