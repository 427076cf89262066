# Vehicles with hinges as FMUs: the core once more, with room for bodies, and again with their friction.

file(GLOB articulated_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/core_c/optional/articulated/*.[ch]")
set(articulated_sources ${articulated_files})
list(FILTER articulated_sources INCLUDE REGEX "\\.c$")
add_library(laconic_fmu_articulated OBJECT ${core_sources} ${articulated_sources})
laconic_fmu_options(laconic_fmu_articulated)
target_include_directories(laconic_fmu_articulated PRIVATE ${core_includes} ${core_folders})

laconic_fmu(LaconicArticulated
    DESCRIPTION "${CMAKE_CURRENT_SOURCE_DIR}/articulated/modelDescription.xml"
    FIELDS "${PROJECT_SOURCE_DIR}/core_c/include/laconic/articulated.h"
    FOLDER articulated
    ICONS vehicle
    SHARED vehicle/core_words.c vehicle/core_words.h vehicle/serialize_core.h
    SOURCES model.c state.c loads.c serialize.c
    HEADERS model.h variable_locations.h parts.h hinged_run.h
    CORE ${core_files} ${articulated_files}
    CORE_OBJECTS laconic_fmu_articulated)

file(GLOB slipping_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/core_c/optional/articulated_friction/*.[ch]")
set(slipping_sources ${slipping_files} ${articulated_sources})
list(FILTER slipping_sources INCLUDE REGEX "\\.c$")
add_library(laconic_fmu_slipping OBJECT ${core_sources} ${slipping_sources})
laconic_fmu_options(laconic_fmu_slipping)
set(hinge_folder "${PROJECT_SOURCE_DIR}/core_c/optional/articulated")
target_include_directories(laconic_fmu_slipping PRIVATE ${core_includes} ${core_folders} "${hinge_folder}")

laconic_fmu(LaconicSlipping SLIPPING
    DESCRIPTION "${CMAKE_CURRENT_SOURCE_DIR}/articulated/modelDescription.xml"
    FIELDS "${PROJECT_SOURCE_DIR}/core_c/include/laconic/articulated_friction.h"
    FOLDER slipping
    ICONS "articulated;vehicle"
    SHARED articulated/variable_locations.h articulated/hinged_run.h vehicle/core_words.c vehicle/core_words.h vehicle/serialize_core.h
    SOURCES model.c
    HEADERS model.h
    CORE ${core_files} ${articulated_files} ${slipping_files}
    INCLUDE "${hinge_folder}"
    CORE_OBJECTS laconic_fmu_slipping)
