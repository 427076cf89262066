/* The refusal of the last call that was refused, as a line of text and by its parts. */
#include "web.h"

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
