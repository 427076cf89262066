/* Tests of record.c: runs along a schedule have the bits of the same steps taken one by one. */
#include "vehicles.h"

#define STEPS 60
#define COLUMNS 4

static laconic_refusal why;
static const uint32_t signals[] = {offsetof(laconic_input, voltage_V) + sizeof(laconic_real),
                                   offsetof(laconic_input, body_moment_Nm)};
static const uint32_t columns[COLUMNS] = {
    offsetof(laconic_outputs, pose.x_m), offsetof(laconic_outputs, nu_rad_per_s) + 2 * sizeof(laconic_real),
    offsetof(laconic_outputs, reactions.no_slip_margin_N), offsetof(laconic_outputs, input.body_moment_Nm)};

static laconic_plant plant_of(laconic_vehicle v, double step) {
    const laconic_start start = start_with(1, 2, 3);
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    v.friction_coefficient = REAL(0.3);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(step), &start, &why));
    return plant;
}

typedef struct film { /* a recorder with its room */
    laconic_contact contact;
    laconic_grip grip;
    laconic_real row[STEPS + 1][COLUMNS];
    laconic_recorder recorder;
} film;

static void load_film(film *f, const laconic_plant *plant, uint64_t every, uint64_t room) {
    memset(f, 0, sizeof *f);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&f->contact, &plant->vehicle, &why));
    f->recorder.contact = &f->contact;
    f->recorder.every = every;
    f->recorder.column_count = COLUMNS;
    f->recorder.column = columns;
    f->recorder.row = &f->row[0][0];
    f->recorder.row_room = room;
}

static void assert_row(const laconic_real row[COLUMNS], const laconic_plant *plant, const laconic_contact *contact,
                       const laconic_input *input) {
    laconic_reactions reactions;
    laconic_real nu[3];
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_reactions_of(&reactions, contact, &plant->model, &plant->state, input);
    TEST_ASSERT_TRUE(row[0] == plant->state.x_m.value);
    TEST_ASSERT_TRUE(row[1] == nu[2]);
    TEST_ASSERT_TRUE(row[2] == reactions.no_slip_margin_N);
    TEST_ASSERT_TRUE(row[3] == input->body_moment_Nm);
}

static const laconic_real held_values[3][2] = {{REAL(1), REAL(0.1)}, {REAL(-2), REAL(0)}, {REAL(0.5), REAL(-0.2)}};
static const uint64_t held_ends[3] = {7, 8, STEPS};

static laconic_schedule held(void) {
    laconic_schedule schedule = {2, signals, &held_values[0][0], held_ends, 3, 0};
    return schedule;
}

static laconic_input held_at(uint64_t step) {
    laconic_input input = no_input();
    const int k = step < 7 ? 0 : step < 8 ? 1 : 2;
    input.voltage_V[1] = held_values[k][0];
    input.body_moment_Nm = held_values[k][1];
    return input;
}

static void a_held_schedule_gives_the_bits_of_running_it_by_hand(void) {
    const uint64_t every[] = {1, 2, 3, 7, STEPS};
    for (int k = 0; k < 5; k++) {
        laconic_plant by_hand = plant_of(with_motors(mecanum()), 0.01), plant = by_hand;
        const laconic_schedule schedule = held();
        laconic_input input;
        uint64_t rows = 0;
        film f;
        load_film(&f, &plant, every[k], STEPS);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
        TEST_ASSERT_EQUAL_UINT64(STEPS, plant.steps);
        for (uint64_t step = 0; step < STEPS; step++) {
            input = held_at(step);
            if (step % every[k] == 0) assert_row(f.row[rows++], &by_hand, &f.contact, &input);
            ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&by_hand, &input, 1, &why));
        }
        TEST_ASSERT_EQUAL_UINT64(rows, f.recorder.row_count);
        TEST_ASSERT_EQUAL_MEMORY(&by_hand.state, &plant.state, sizeof plant.state);
        f.recorder.row_room++;
        laconic_record_row(&f.recorder, &plant, &input);
        assert_row(f.row[rows], &by_hand, &f.contact, &input);
    }
}

static laconic_real sampled_values[STEPS][3][2];

static laconic_schedule sampled(void) {
    const laconic_schedule schedule = {2, signals, &sampled_values[0][0][0], NULL, STEPS, 0};
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < 3; k++) {
            sampled_values[i][k][0] = REAL(sin(0.1 * (i + 0.5 * k)));
            sampled_values[i][k][1] = REAL(0.1 * cos(0.07 * (i + 0.5 * k)));
        }
    return schedule;
}

static void sampled_at(laconic_input input[3], uint64_t step) {
    for (int k = 0; k < 3; k++) {
        input[k] = no_input();
        input[k].voltage_V[1] = sampled_values[step][k][0];
        input[k].body_moment_Nm = sampled_values[step][k][1];
    }
}

static void a_sampled_schedule_gives_the_bits_of_sampled_steps(void) {
    laconic_plant by_hand = plant_of(with_motors(mecanum()), 0.01), plant = by_hand;
    const laconic_schedule schedule = sampled();
    laconic_input input[3];
    film f;
    load_film(&f, &plant, 2, STEPS);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS + 5, &f.recorder, &why));
    TEST_ASSERT_EQUAL_UINT64(STEPS, plant.steps); /* where the schedule ends */
    TEST_ASSERT_EQUAL_UINT64(STEPS / 2, f.recorder.row_count);
    for (uint64_t step = 0; step < STEPS; step++) {
        sampled_at(input, step);
        if (step % 2 == 0) assert_row(f.row[step / 2], &by_hand, &f.contact, input);
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&by_hand.model, &by_hand.integrator, &by_hand.state, input,
                                                       input + 1, input + 2));
    }
    TEST_ASSERT_EQUAL_MEMORY(&by_hand.state, &plant.state, sizeof plant.state);
}

static void pieces_of_any_length_are_the_whole(laconic_schedule schedule) {
    laconic_plant whole = plant_of(with_motors(mecanum()), 0.01), pieces = whole;
    film one, many;
    load_film(&one, &whole, 3, STEPS);
    load_film(&many, &pieces, 3, STEPS);
    one.recorder.grip = &one.grip;
    many.recorder.grip = &many.grip;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&whole, &schedule, STEPS, &one.recorder, &why));
    for (uint64_t until = 0; pieces.steps < STEPS; until += 1 + until % 4)
        ASSERT_STATUS(LACONIC_OK,
                      laconic_plant_follow(&pieces, &schedule, until < STEPS ? until : STEPS, &many.recorder, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&whole.state, &pieces.state, sizeof whole.state);
    TEST_ASSERT_EQUAL_MEMORY(one.row, many.row, sizeof one.row);
    TEST_ASSERT_EQUAL_UINT64(STEPS, many.grip.instants);
    TEST_ASSERT_EQUAL_UINT64(one.grip.slipping, many.grip.slipping);
    TEST_ASSERT_TRUE(one.grip.slipping > 0);
}

static void a_run_in_pieces_is_the_run_in_one(void) {
    pieces_of_any_length_are_the_whole(held());
    pieces_of_any_length_are_the_whole(sampled());
}

static void a_later_piece_of_a_sampled_run_has_a_schedule_of_its_own(void) {
    laconic_plant whole = plant_of(with_motors(mecanum()), 0.01), pieces = whole;
    laconic_schedule schedule = sampled();
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&whole, &schedule, STEPS, NULL, &why));
    schedule.count = 20;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&pieces, &schedule, STEPS, NULL, &why));
    schedule.first_step = 20;
    schedule.count = STEPS - 20;
    schedule.value = &sampled_values[20][0][0];
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&pieces, &schedule, STEPS, NULL, &why));
    TEST_ASSERT_EQUAL_MEMORY(&whole.state, &pieces.state, sizeof whole.state);
}

static void stops_before_a_row_without_room(laconic_schedule schedule) {
    laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
    film f;
    load_film(&f, &plant, 4, 3);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
    TEST_ASSERT_EQUAL_UINT64(12, plant.steps);
    TEST_ASSERT_EQUAL_UINT64(3, f.recorder.row_count);
    f.recorder.row_room = 5;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
    TEST_ASSERT_EQUAL_UINT64(20, plant.steps);
    TEST_ASSERT_TRUE(f.row[5][0] == REAL(0));
}

static void a_held_schedule_may_begin_at_any_step_of_the_plant(void) {
    laconic_plant early = plant_of(with_motors(mecanum()), 0.01), late = early;
    laconic_schedule schedule = held();
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&early, &schedule, STEPS, NULL, &why));
    late.steps = schedule.first_step = 1000;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&late, &schedule, UINT64_MAX, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(1000 + STEPS, late.steps);
    TEST_ASSERT_EQUAL_MEMORY(&early.state, &late.state, sizeof late.state);
}

/* Neither until a step that has passed, nor beyond the schedule's end, nor before it begins. */
static void where_nothing_is_left_no_step_is_taken(laconic_schedule schedule) {
    const struct {
        uint64_t taken, until;
    } nothing_left[] = {{20, 15}, {20, 20}, {10 + STEPS, UINT64_MAX}, {15 + STEPS, UINT64_MAX}, {9, UINT64_MAX}};
    laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
    film f;
    load_film(&f, &plant, 1, STEPS);
    schedule.first_step = 10;
    for (size_t k = 0; k < sizeof nothing_left / sizeof nothing_left[0]; k++) {
        plant.steps = nothing_left[k].taken;
        const laconic_plant before = plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, nothing_left[k].until, &f.recorder, &why));
        TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
    }
    TEST_ASSERT_EQUAL_UINT64(0, f.recorder.row_count);
}

static void outside_of_its_schedule_a_plant_stands_still(void) {
    where_nothing_is_left_no_step_is_taken(held());
    where_nothing_is_left_no_step_is_taken(sampled());
}

static void a_full_recorder_stops_the_run_where_it_can_go_on(void) {
    stops_before_a_row_without_room(held());
    stops_before_a_row_without_room(sampled());
}

static void a_recorder_that_is_full_before_the_last_stretch_stops_there(void) {
    laconic_plant plant = plant_of(with_motors(mecanum()), 0.01), whole = plant;
    const laconic_schedule schedule = held();
    film f;
    load_film(&f, &plant, 4, 1);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
    TEST_ASSERT_EQUAL_UINT64(4, plant.steps);
    f.recorder.row_room = STEPS;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&whole, &schedule, STEPS, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(STEPS / 4, f.recorder.row_count);
    TEST_ASSERT_EQUAL_MEMORY(&whole.state, &plant.state, sizeof whole.state);
}

static void without_rows_and_watch_the_plant_only_steps(void) {
    laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
    const laconic_schedule schedule = held();
    film f;
    for (uint64_t room = 0; room < 2; room++) {
        plant.steps = 0;
        load_film(&f, &plant, 0, room);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
        TEST_ASSERT_EQUAL_UINT64(STEPS, plant.steps);
        TEST_ASSERT_EQUAL_UINT64(0, f.recorder.row_count);
    }
}

/* The first row is that of the first step that it divides, and without room for it the run ends there. */
static void between_two_rows_a_run_may_begin(void) {
    const laconic_schedule schedule = held();
    for (uint64_t room = 0; room < 3; room++) {
        laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
        film f;
        plant.steps = 1;
        load_film(&f, &plant, 4, room);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why));
        TEST_ASSERT_EQUAL_UINT64(4 + 4 * room, plant.steps);
        TEST_ASSERT_EQUAL_UINT64(room, f.recorder.row_count);
    }
}

static void a_run_may_end_at_any_step_of_a_stretch(void) {
    const laconic_schedule schedule = held();
    laconic_plant by_hand = plant_of(with_motors(mecanum()), 0.01);
    const laconic_plant start = by_hand;
    for (uint64_t until = 1; until < 12; until++) {
        laconic_plant plant = start;
        const laconic_input input = held_at(until - 1);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&by_hand, &input, 1, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, until, NULL, &why));
        TEST_ASSERT_EQUAL_MEMORY(&by_hand.state, &plant.state, sizeof plant.state);
    }
}

static void a_refused_step_keeps_the_steps_taken_and_gives_the_reason(void) {
    laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
    laconic_schedule schedule = sampled();
    film f;
    load_film(&f, &plant, 1, STEPS);
    sampled_values[9][1][1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0,
                   laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why), why);
    TEST_ASSERT_EQUAL_UINT64(9, plant.steps);
    TEST_ASSERT_EQUAL_UINT64(10, f.recorder.row_count);
    plant = plant_of(with_motors(mecanum()), 0.01);
    schedule = sampled();
    plant.state.heading.turns = INT64_MAX;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, laconic_plant_follow(&plant, &schedule, STEPS, NULL, &why),
                   why);
    TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
    sampled_values[9][1][1] = NOT_A_NUMBER;
    plant = plant_of(three_wheels(), 0.01);
    schedule = held();
    schedule.value = &sampled_values[9][1][0]; /* a stretch whose second value is not finite */
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0,
                   laconic_plant_follow(&plant, &schedule, STEPS, NULL, &why), why);
    TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
}

/* By the check of the input, and by the step itself. */
static void a_step_that_is_refused_beside_sensors_gives_the_reason_too(void) {
    for (int k = 0; k < 4; k++) {
        const bool is_held = k % 2 == 0, turns_too_far = k / 2 == 1;
        laconic_plant plant = plant_of(with_motors(mecanum()), 0.01);
        laconic_sensor_settings settings;
        laconic_sensors sensors;
        laconic_schedule schedule = is_held ? held() : sampled();
        film f;
        memset(&settings, 0, sizeof settings);
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
        load_film(&f, &plant, 1, STEPS);
        f.recorder.sensors = &sensors;
        if (turns_too_far) {
            plant.state.heading.turns = INT64_MAX;
            ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0,
                           laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why), why);
        } else {
            sampled_values[0][1][1] = NOT_A_NUMBER;
            if (is_held) schedule.value = &sampled_values[0][1][0];
            ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0,
                           laconic_plant_follow(&plant, &schedule, STEPS, &f.recorder, &why), why);
        }
        TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
    }
}

static void a_schedule_tells_the_inputs_of_a_step(void) {
    laconic_schedule schedule = held();
    laconic_input inputs[3];
    uint64_t end = 0;
    schedule.first_step = 100;
    inputs[1] = inputs[2] = every_input();
    const laconic_input others = inputs[1];
    TEST_ASSERT_EQUAL_INT(1, laconic_schedule_at(inputs, &end, &schedule, 107));
    TEST_ASSERT_EQUAL_UINT64(108, end);
    for (int k = 1; k < 3; k++) TEST_ASSERT_EQUAL_MEMORY(&others, &inputs[k], sizeof others);
    TEST_ASSERT_TRUE(inputs[0].voltage_V[1] == -2 && inputs[0].voltage_V[0] == 0);
    TEST_ASSERT_EQUAL_INT(0, laconic_schedule_at(inputs, &end, &schedule, 100 + STEPS));
    schedule = sampled();
    schedule.first_step = 100;
    TEST_ASSERT_EQUAL_INT(3, laconic_schedule_at(inputs, &end, &schedule, 102));
    TEST_ASSERT_EQUAL_UINT64(103, end);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(inputs[k].voltage_V[1] == sampled_values[2][k][0]);
    TEST_ASSERT_EQUAL_INT(0, laconic_schedule_at(inputs, &end, &schedule, 100 + STEPS));
}

static void of_many_stretches_each_step_has_its_own(void) {
    static const laconic_real values[9][2] = {{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}, {8}};
    const uint64_t ends[9] = {1, 2, 4, 5, 8, 9, 10, 13, 14};
    for (uint64_t count = 1; count <= 9; count++) {
        const laconic_schedule schedule = {2, signals, &values[0][0], ends, count, 100};
        uint64_t k = 0, end;
        laconic_input inputs[3];
        for (uint64_t step = 0; step < ends[count - 1]; step++) {
            if (step == ends[k]) k++;
            TEST_ASSERT_EQUAL_INT(1, laconic_schedule_at(inputs, &end, &schedule, 100 + step));
            TEST_ASSERT_TRUE((double)inputs[0].voltage_V[1] == (double)k && end == 100 + ends[k]);
        }
        TEST_ASSERT_EQUAL_INT(0, laconic_schedule_at(inputs, &end, &schedule, 100 + ends[count - 1] + 5));
    }
    laconic_schedule each = sampled();
    uint64_t end;
    laconic_input inputs[3];
    each.first_step = 100;
    TEST_ASSERT_EQUAL_INT(0, laconic_schedule_at(inputs, &end, &each, 100 + STEPS + 5));
    TEST_ASSERT_EQUAL_INT(0, laconic_schedule_at(inputs, &end, &each, 99));
}

static void a_stretch_may_last_for_ever(void) {
    const uint64_t for_ever = UINT64_MAX;
    laconic_schedule schedule = held();
    laconic_input inputs[3];
    uint64_t end = 0;
    schedule.until_step = &for_ever;
    schedule.count = 1;
    schedule.first_step = 7;
    TEST_ASSERT_EQUAL_INT(1, laconic_schedule_at(inputs, &end, &schedule, 1000));
    TEST_ASSERT_TRUE(end == UINT64_MAX);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_held_schedule_gives_the_bits_of_running_it_by_hand);
    RUN_TEST(a_sampled_schedule_gives_the_bits_of_sampled_steps);
    RUN_TEST(a_run_in_pieces_is_the_run_in_one);
    RUN_TEST(a_later_piece_of_a_sampled_run_has_a_schedule_of_its_own);
    RUN_TEST(a_held_schedule_may_begin_at_any_step_of_the_plant);
    RUN_TEST(outside_of_its_schedule_a_plant_stands_still);
    RUN_TEST(a_full_recorder_stops_the_run_where_it_can_go_on);
    RUN_TEST(a_recorder_that_is_full_before_the_last_stretch_stops_there);
    RUN_TEST(without_rows_and_watch_the_plant_only_steps);
    RUN_TEST(a_refused_step_keeps_the_steps_taken_and_gives_the_reason);
    RUN_TEST(a_step_that_is_refused_beside_sensors_gives_the_reason_too);
    RUN_TEST(a_schedule_tells_the_inputs_of_a_step);
    RUN_TEST(between_two_rows_a_run_may_begin);
    RUN_TEST(a_run_may_end_at_any_step_of_a_stretch);
    RUN_TEST(of_many_stretches_each_step_has_its_own);
    RUN_TEST(a_stretch_may_last_for_ever);
    return UNITY_END();
}
