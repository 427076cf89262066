# Vehicles with hinges as FMU: the core once more, with room for bodies.

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
    SOURCES model.c state.c idle.c exchange.c loads.c serialize.c
    HEADERS model.h variable_locations.h parts.h
    CORE ${core_files} ${articulated_files}
    CORE_OBJECTS laconic_fmu_articulated)
