/* What the core calls its fields and methods, and the text of a refusal. */
#include "web.h"

WEB_EXPORT(laconic_web_field_path) const char *laconic_web_field_path(int32_t field) {
    return laconic_field_path((laconic_field)field);
}

/* laconic_field_kind; −1 for a number that is no field. */
WEB_EXPORT(laconic_web_field_kind) int32_t laconic_web_field_kind(int32_t field) {
    const laconic_field_traits *traits = laconic_field_traits_of((laconic_field)field);
    return traits != NULL ? (int32_t)traits->kind : -1;
}

/* laconic_field_need; −1 for a number that is no field. */
WEB_EXPORT(laconic_web_field_need) int32_t laconic_web_field_need(int32_t field) {
    const laconic_field_traits *traits = laconic_field_traits_of((laconic_field)field);
    return traits != NULL ? (int32_t)traits->need : -1;
}

WEB_EXPORT(laconic_web_field_count) int32_t laconic_web_field_count(void) { return LACONIC_WEB_FIELD_COUNT; }

#ifdef LACONIC_WEB_HINGES
/* NULL beyond the last. */
WEB_EXPORT(laconic_web_method_name) const char *laconic_web_method_name(int32_t number) {
    return number < LACONIC_ARTICULATED_METHOD_COUNT ? laconic_articulated_method_name(number) : NULL;
}

/* Of all of them: articulated.h. */
WEB_EXPORT(laconic_web_method_order) int32_t laconic_web_method_order(int32_t number) {
    (void)number;
    return 4;
}

WEB_EXPORT(laconic_web_max_bodies) int32_t laconic_web_max_bodies(void) { return LACONIC_MAX_BODIES; }
#else
/* NULL beyond the last. */
WEB_EXPORT(laconic_web_method_name) const char *laconic_web_method_name(int32_t number) {
    const laconic_method *method = laconic_method_by_number(number);
    return method != NULL ? method->name : NULL;
}

WEB_EXPORT(laconic_web_method_order) int32_t laconic_web_method_order(int32_t number) {
    const laconic_method *method = laconic_method_by_number(number);
    return method != NULL ? method->order : 0;
}
#endif

WEB_EXPORT(laconic_web_version) const char *laconic_web_version(void) { return LACONIC_VERSION; }

WEB_EXPORT(laconic_web_max_wheels) int32_t laconic_web_max_wheels(void) { return LACONIC_MAX_WHEELS; }

WEB_EXPORT(laconic_web_status_name) const char *laconic_web_status_name(int32_t status) {
    return laconic_status_name((laconic_status)status);
}

/* laconic_arithmetic of the engine that runs this module; 0: sound. */
WEB_EXPORT(laconic_web_self_test) int32_t laconic_web_self_test(void) { return (int32_t)laconic_self_test(); }

laconic_status laconic_web_refuse(laconic_web_robot *robot) {
    laconic_message(&robot->why, robot->text, sizeof robot->text);
    return robot->why.status;
}

WEB_EXPORT(laconic_web_text) const char *laconic_web_text(const laconic_web_robot *robot) { return robot->text; }
WEB_EXPORT(laconic_web_refused_status) int32_t laconic_web_refused_status(const laconic_web_robot *robot) {
    return (int32_t)robot->why.status;
}
WEB_EXPORT(laconic_web_refused_field) int32_t laconic_web_refused_field(const laconic_web_robot *robot) {
    return (int32_t)robot->why.field;
}
WEB_EXPORT(laconic_web_refused_value) double laconic_web_refused_value(const laconic_web_robot *robot) {
    return robot->why.value;
}
WEB_EXPORT(laconic_web_refused_limit) double laconic_web_refused_limit(const laconic_web_robot *robot) {
    return robot->why.limit;
}
