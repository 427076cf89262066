# Unity, the C test framework, as target `laconic_unity`; and laconic_unity_test() to use it.
#
# It comes from -DUNITY_DIR, else from an installed package, else it is fetched at build time with its hashes checked
# (cmake/fetch_parts.py: from the project's own site, else from a source archive on the configured package index).

set(UNITY_DIR "" CACHE PATH "Folder that holds unity.c, unity.h and unity_internals.h")
find_package(unity CONFIG QUIET)

if(unity_FOUND AND NOT UNITY_DIR)
    add_library(laconic_unity INTERFACE)
    target_link_libraries(laconic_unity INTERFACE unity::framework)
else()
    set(unity_files unity.c unity.h unity_internals.h)
    if(UNITY_DIR)
        set(unity_folder "${UNITY_DIR}")
        if(NOT EXISTS "${UNITY_DIR}/unity.c")
            message(FATAL_ERROR "laconic: UNITY_DIR=${UNITY_DIR} holds no unity.c: name the folder that does")
        endif()
    else()
        set(unity_folder "${CMAKE_BINARY_DIR}/parts/unity")
        list(TRANSFORM unity_files PREPEND "${unity_folder}/" OUTPUT_VARIABLE unity_outputs)
        add_custom_command(
            OUTPUT ${unity_outputs}
            COMMAND "${LACONIC_PYTHON}" "${PROJECT_SOURCE_DIR}/cmake/fetch_parts.py" unity "${unity_folder}"
            DEPENDS "${PROJECT_SOURCE_DIR}/cmake/fetch_parts.py"
            COMMENT "Unity" VERBATIM)
        add_custom_target(laconic_unity_there DEPENDS ${unity_outputs})
        add_dependencies(laconic_unity_there laconic_venv_pip)
    endif()
    list(TRANSFORM unity_files PREPEND "${unity_folder}/")
    add_library(laconic_unity STATIC EXCLUDE_FROM_ALL ${unity_files})
    if(TARGET laconic_unity_there)
        add_dependencies(laconic_unity laconic_unity_there)
    endif()
    target_include_directories(laconic_unity SYSTEM PUBLIC "${unity_folder}")
    target_compile_definitions(laconic_unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
    if(LACONIC_SANITIZE)
        target_link_options(laconic_unity PUBLIC -fsanitize=${LACONIC_SANITIZE})
    endif()
endif()

# The tests' own files are compiled without optimisation, in a third of the time; the libraries that they test are
# optimised as ever.
add_custom_target(laconic_unity_tests) # all of them

# laconic_unity_test(<name> SOURCES <files> [LIBRARIES <targets>] [DEFINITIONS <macros>]): a program that ctest runs.
function(laconic_unity_test name)
    cmake_parse_arguments(PARSE_ARGV 1 test "" "" "SOURCES;LIBRARIES;DEFINITIONS")
    add_executable(${name} ${test_SOURCES})
    laconic_strict(${name})
    target_link_libraries(${name} PRIVATE ${test_LIBRARIES} laconic_unity)
    target_compile_definitions(${name} PRIVATE ${test_DEFINITIONS})
    target_compile_options(${name} PRIVATE -O0)
    add_dependencies(laconic_unity_tests ${name})
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 60 LABELS unity)
    if(LACONIC_SANITIZE OR LACONIC_COVERAGE)
        set_tests_properties(${name} PROPERTIES TIMEOUT 300)
    endif()
endfunction()
