/* Macros with which a model gives the location of each variable: FMU_LOCATION(name, offset, stride, group, tangent
 * offset) in an enumeration. The generated table uses the four constants of each variable of the description, so a
 * variable without a location does not compile. */
#ifndef LACONIC_FMU_LOCATION_MACROS_H
#define LACONIC_FMU_LOCATION_MACROS_H

#include <stddef.h>

#define FMU_LOCATION(...) FMU_LOCATION_OF(__VA_ARGS__) /* expands the macros below to several arguments */
#define FMU_LOCATION_OF(name, offset, stride, group, tangent) \
    FMU_OFFSET_##name = offset, FMU_STRIDE_##name = stride, FMU_GROUP_OF_##name = group, FMU_TANGENT_##name = tangent,

#define FMU_AT(member) offsetof(fmu_model, member)
#define FMU_ALONG(member) offsetof(fmu_tangent, member)
#define FMU_NO_TANGENT (-1)

/* FMU_PLAIN: a number without derivatives. FMU_MOVING: doubles with derivatives, in the same member of fmu_tangent. */
#define FMU_PLAIN(member) FMU_AT(member), sizeof(((fmu_model *)NULL)->member), 0, FMU_NO_TANGENT
#define FMU_MOVING(member, group) FMU_AT(member), sizeof(double), group, FMU_ALONG(member)

#endif
