# The headers of FMI 2 and FMI 3 as target `laconic_fmi_headers` (SYSTEM includes).
#
# They come from -DFMI_HEADERS_DIR, else they are fetched at build time (cmake/fetch_parts.py: from the standard's own
# site with hashes checked, else from the copies in the installed FMPy).

set(FMI_HEADERS_DIR "" CACHE PATH "Folder that holds fmi2Functions.h, fmi3Functions.h and what they include")
add_library(laconic_fmi_headers INTERFACE)

if(FMI_HEADERS_DIR)
    if(NOT EXISTS "${FMI_HEADERS_DIR}/fmi2Functions.h" OR NOT EXISTS "${FMI_HEADERS_DIR}/fmi3Functions.h")
        message(FATAL_ERROR "laconic: FMI_HEADERS_DIR=${FMI_HEADERS_DIR} lacks fmi2Functions.h or fmi3Functions.h: "
                            "put the headers of both versions into one folder")
    endif()
    set(LACONIC_FMI_HEADERS_FOLDER "${FMI_HEADERS_DIR}")
else()
    set(LACONIC_FMI_HEADERS_FOLDER "${CMAKE_BINARY_DIR}/parts/fmi")
    set(fmi_outputs "")
    foreach(header fmi2FunctionTypes fmi2Functions fmi2TypesPlatform fmi3FunctionTypes fmi3Functions fmi3PlatformTypes)
        list(APPEND fmi_outputs "${LACONIC_FMI_HEADERS_FOLDER}/${header}.h")
    endforeach()
    add_custom_command(
        OUTPUT ${fmi_outputs}
        COMMAND "${LACONIC_PYTHON}" "${PROJECT_SOURCE_DIR}/cmake/fetch_parts.py" fmi "${LACONIC_FMI_HEADERS_FOLDER}"
        DEPENDS "${PROJECT_SOURCE_DIR}/cmake/fetch_parts.py"
        COMMENT "FMI headers" VERBATIM)
    add_custom_target(laconic_fmi_headers_there DEPENDS ${fmi_outputs})
    add_dependencies(laconic_fmi_headers_there laconic_venv)
    add_dependencies(laconic_fmi_headers laconic_fmi_headers_there)
endif()
target_include_directories(laconic_fmi_headers SYSTEM INTERFACE "${LACONIC_FMI_HEADERS_FOLDER}")
