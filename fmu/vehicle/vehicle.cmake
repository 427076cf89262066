# The vehicle as FMU, and again with derivatives of its steps, and with an error estimate.

set(vehicle_sources model.c core_words.c friction_part.c warnings.c sensors_part.c tangent.c serialize.c)
set(vehicle_headers variable_locations.h core_words.h parts.h serialize_core.h)
set(vehicle_description "${PROJECT_SOURCE_DIR}/modelDescription.xml")

laconic_fmu(Laconic
    DESCRIPTION "${vehicle_description}"
    FIELDS "${PROJECT_SOURCE_DIR}/core_c/include/laconic/vehicle.h" "${PROJECT_SOURCE_DIR}/core_c/include/laconic/sensors.h"
    METHODS "${PROJECT_SOURCE_DIR}/core_c/include/laconic/methods.h"
    FOLDER vehicle
    SOURCES ${vehicle_sources}
    HEADERS model.h ${vehicle_headers}
    CORE ${core_files})

# laconic_vehicle_with(<identifier> <option of laconic_fmu> <switch> <file> <folder>): the vehicle and a part of it in <file>,
# by an optional part of the core, in core_c/optional/<folder>. In its sources/ model.h has the switch on.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS vehicle/model.h)
function(laconic_vehicle_with identifier option switch file folder)
    file(READ vehicle/model.h model_text)
    string(REPLACE "${switch} 0" "${switch} 1" model_text "${model_text}")
    set(model "${CMAKE_CURRENT_BINARY_DIR}/${identifier}/model.h")
    file(CONFIGURE OUTPUT "${model}" CONTENT "${model_text}" @ONLY)
    file(GLOB part_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/core_c/optional/${folder}/*.[ch]")
    set(part_sources ${part_files})
    list(FILTER part_sources INCLUDE REGEX "\\.c$")
    add_library(laconic_fmu_${folder} OBJECT ${part_sources})
    laconic_fmu_options(laconic_fmu_${folder})
    target_include_directories(laconic_fmu_${folder} PRIVATE ${core_includes} ${core_folders})
    laconic_fmu(${identifier} ${option}
        DESCRIPTION "${vehicle_description}"
        FOLDER vehicle
        SOURCES ${vehicle_sources} ${file}
        HEADERS ${vehicle_headers}
        FILES "model.h=${model}"
        CORE ${core_files} ${part_files}
        OBJECTS laconic_fmu_${folder}
        INCLUDE ${core_folders}
        DEFINITIONS ${switch}=1)
endfunction()

laconic_vehicle_with(LaconicDerivatives OF_STEP FMU_MODEL_KEEPS_STEPS kept_step.c derivatives)
target_compile_options(laconic_fmu_derivatives PRIVATE "$<$<CONFIG:Release>:-Os>") # seldom called
laconic_vehicle_with(LaconicEstimate ESTIMATE FMU_MODEL_ESTIMATES estimate_part.c estimate)
list(TRANSFORM vehicle_sources PREPEND "vehicle/") # for programs that compile them otherwise
