/* How a model says where its variables live: for each, FMU_LOCATION(name, offset, stride, group, tangent offset) in an
 * enumeration. The generated table asks for the four constants of each variable of the description; a name without a
 * place does not compile. */
#ifndef LACONIC_FMU_LOCATION_MACROS_H
#define LACONIC_FMU_LOCATION_MACROS_H

#include <stddef.h>

#define FMU_LOCATION(...) FMU_LOCATION_OF(__VA_ARGS__) /* so that the macros below become several arguments */
#define FMU_LOCATION_OF(name, offset, stride, group, tangent) \
    FMU_OFFSET_##name = offset, FMU_STRIDE_##name = stride, FMU_GROUP_OF_##name = group, FMU_TANGENT_##name = tangent,

#define FMU_AT(member) offsetof(fmu_model, member)
#define FMU_ALONG(member) offsetof(fmu_tangent, member)
#define FMU_NO_TANGENT (-1)

/* A number that is set, and doubles that have a direction. */
#define FMU_PLAIN(member) FMU_AT(member), sizeof(((fmu_model *)NULL)->member), 0, FMU_NO_TANGENT
#define FMU_MOVING(member, group) FMU_AT(member), sizeof(double), group, FMU_ALONG(member)

#endif
