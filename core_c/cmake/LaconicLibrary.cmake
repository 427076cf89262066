# laconic_library(<double|single> [STATIC] <sources>…): the core as laconic::core or laconic::core_single.
#
# Their functions have the same names, so CMake refuses a program that links both (LACONIC_REAL must agree).

function(laconic_library real)
    set(target laconic_core_${real})
    if(real STREQUAL "single")
        set(name core_single)
        set(file laconic_single)
    else()
        set(name core)
        set(file laconic)
    endif()
    add_library(${target} ${ARGN})
    add_library(laconic::${name} ALIAS ${target})
    target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>"
        "$<INSTALL_INTERFACE:include>" PRIVATE ${core_folders} ${optional_folders})
    target_compile_definitions(${target} PUBLIC $<$<STREQUAL:${real},single>:LACONIC_SINGLE>)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME ${file} LINKER_LANGUAGE C
        VERSION ${LACONIC_VERSION} SOVERSION ${LACONIC_ABI} WINDOWS_EXPORT_ALL_SYMBOLS ON
        INTERFACE_LACONIC_REAL ${real} COMPATIBLE_INTERFACE_STRING LACONIC_REAL)
    laconic_compiled(${target})
    laconic_names(${target} ${real})
endfunction()

# Double and single have the same names, and may be in one process, as in two plugins. So a static library brings no names
# to the plugin that contains it, and names of a shared one have its scalar type and version as theirs.
include(CheckLinkerFlag)
set_property(GLOBAL PROPERTY LACONIC_ABI "${LACONIC_ABI}") # for other folders
function(laconic_names target real)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
        set_target_properties(${target} PROPERTIES C_VISIBILITY_PRESET hidden)
        return()
    endif()
    set(names "${CMAKE_CURRENT_BINARY_DIR}/${target}.names")
    get_property(abi GLOBAL PROPERTY LACONIC_ABI)
    file(WRITE "${names}" "laconic_${real}_${abi} { global: laconic*; local: *; };\n")
    check_linker_flag(C "-Wl,--version-script=${names}" LACONIC_LINKER_HAS_VERSIONS)
    if(LACONIC_LINKER_HAS_VERSIONS)
        target_link_options(${target} PRIVATE "-Wl,--version-script=${names}")
        set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${names}")
    endif()
endfunction()

# How the core's files are compiled. Code that is independent of its address can be linked into any library; on a
# microcontroller it would ask for a table of addresses.
function(laconic_compiled target)
    laconic_arithmetic(${target})
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
    get_property(hosted GLOBAL PROPERTY TARGET_SUPPORTS_SHARED_LIBS)
    if(hosted AND NOT DEFINED CMAKE_POSITION_INDEPENDENT_CODE)
        set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    endif()
endfunction()
