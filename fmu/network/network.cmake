# The FMUs with bus terminals: FMI 3 only, Co-Simulation only, with the glue of the others but its steps.

set(network_glue instance.c lifecycle.c log.c variables.c cached_reals.c start_file.c clock.c saved_states.c stream.c)
list(TRANSFORM network_glue PREPEND "glue/")
list(APPEND network_glue network/event_model.c network/step.c network/fmi3_clocks.c network/network_port.c network/ls_bus.c)
set(network_files "")
foreach(name network_port.h ls_bus.h)
    list(APPEND network_files "${name}=${CMAKE_CURRENT_SOURCE_DIR}/network/${name}")
endforeach()
set(firmware "${PROJECT_SOURCE_DIR}/firmware_stub")
list(APPEND network_files "laconic_node/frame.h=${firmware}/include/laconic_node/frame.h")
foreach(is_bus true false)
    set(manifest "${CMAKE_CURRENT_BINARY_DIR}/network/is_bus_${is_bus}.xml")
    configure_file(network/fmi-ls-manifest.xml "${manifest}" @ONLY)
    set(manifest_${is_bus} "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml=${manifest}")
endforeach()

# The node's sources, as a board compiles them, with the core's scalar type; the wire contract is generated.
file(GLOB node_files CONFIGURE_DEPENDS RELATIVE "${firmware}" "${firmware}/node/*.[ch]" "${firmware}/wire/*.[ch]"
     "${firmware}/drives/*.[ch]"
     "${firmware}/drives/*/*.[ch]" "${firmware}/include/laconic_*/*.h")
list(FILTER node_files EXCLUDE REGEX "slcan|/describe\\.") # for serial lines and the EDS file
list(REMOVE_ITEM node_files include/laconic_node/frame.h)
set(node_named "")
foreach(path ${node_files})
    string(REGEX REPLACE "^(node|wire|include)/" "" name "${path}")
    list(APPEND node_named "${name}=${firmware}/${path}")
endforeach()
set(wire "${PROJECT_BINARY_DIR}/firmware_stub/wire")
foreach(name laconic_wire.c laconic_wire.h laconic_dbc.c laconic_dbc.h)
    list(APPEND node_named "${name}=${wire}/${name}")
endforeach()
list(FILTER node_files INCLUDE REGEX "\\.c$")
list(TRANSFORM node_files PREPEND "${firmware}/")
add_library(laconic_fmu_node OBJECT ${node_files})
laconic_fmu_options(laconic_fmu_node)
add_library(laconic_fmu_wire OBJECT "${wire}/laconic_wire.c" "${wire}/laconic_dbc.c")
set_target_properties(laconic_fmu_wire PROPERTIES POSITION_INDEPENDENT_CODE ON C_VISIBILITY_PRESET hidden)
target_compile_options(laconic_fmu_wire PRIVATE -ffunction-sections -fdata-sections)
laconic_instrument(laconic_fmu_wire)
foreach(target laconic_fmu_node laconic_fmu_wire)
    set_source_files_properties("${wire}/laconic_wire.c" "${wire}/laconic_dbc.c" PROPERTIES GENERATED TRUE)
    target_include_directories(${target} SYSTEM PRIVATE "${wire}")
    target_include_directories(${target} PRIVATE "${firmware}/include" "${firmware}/node" "${firmware}/drives"
        ${core_includes})
    add_dependencies(${target} laconic_wire_files)
endforeach()

laconic_fmu(LaconicNode
    DESCRIPTION "${CMAKE_CURRENT_SOURCE_DIR}/network/node/modelDescription.xml"
    FOLDER network/node
    ICONS network
    SOURCES model.c
    HEADERS model.h variable_locations.h
    CORE ${core_files}
    VERSIONS 3
    GLUE ${network_glue} network/can_controller.c
    FILES ${network_files} "can_controller.h=${CMAKE_CURRENT_SOURCE_DIR}/network/can_controller.h" ${node_named}
    OBJECTS laconic_fmu_node laconic_fmu_wire
    INCLUDE "${CMAKE_CURRENT_SOURCE_DIR}/network" "${firmware}/include" "${firmware}/node" "${firmware}/drives" "${wire}"
    PARTS "${manifest_false}"
    DEPENDS laconic_wire_files)

laconic_fmu(LaconicCanBus
    DESCRIPTION "${CMAKE_CURRENT_SOURCE_DIR}/network/bus/modelDescription.xml"
    FOLDER network/bus
    SOURCES model.c frame_time.c
    HEADERS model.h variable_locations.h frame_time.h
    VERSIONS 3
    GLUE ${network_glue}
    FILES ${network_files}
    INCLUDE "${CMAKE_CURRENT_SOURCE_DIR}/network" "${firmware}/include"
    PARTS "${manifest_true}")

laconic_fmu(LaconicCanController
    DESCRIPTION "${CMAKE_CURRENT_SOURCE_DIR}/network/robomaster/modelDescription.xml"
    FOLDER network/robomaster
    ICONS network
    SOURCES model.c
    HEADERS model.h variable_locations.h
    VERSIONS 3
    GLUE ${network_glue} network/can_controller.c
    FILES ${network_files} "can_controller.h=${CMAKE_CURRENT_SOURCE_DIR}/network/can_controller.h"
    INCLUDE "${CMAKE_CURRENT_SOURCE_DIR}/network" "${firmware}/include"
    PARTS "${manifest_false}")
