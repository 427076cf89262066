# -DLACONIC_SCENE=scenes/X.toml: the core for that scene alone, as target `laconic_scene` (lib/liblaconic_scene.a).
#
# `laconic trim` finds from the scene what a build can leave out (laconic_scene.h) and prepares its model
# (laconic_scene_model.c), so the linker takes one method and no preparation. Users of the target get the same
# constants. Cross builds use the environment of a host build: name it with -DLACONIC_VENV=<host build>/venv.

set(LACONIC_SCENE_REAL "" CACHE STRING "double or single; empty: as in the scene")

cmake_path(ABSOLUTE_PATH LACONIC_SCENE BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" NORMALIZE OUTPUT_VARIABLE scene_file)
if(NOT EXISTS "${scene_file}")
    message(FATAL_ERROR "laconic: LACONIC_SCENE=${LACONIC_SCENE}: no such scene file: name one of scenes/*.toml")
endif()
set(scene_real "${LACONIC_SCENE_REAL}")
if(NOT scene_real)
    file(STRINGS "${scene_file}" single_line REGEX "^real *= *[\"']single[\"']")
    if(single_line)
        set(scene_real single)
    else()
        set(scene_real double)
    endif()
endif()
if(NOT scene_real MATCHES "^(double|single)$")
    message(FATAL_ERROR "laconic: LACONIC_SCENE_REAL=${LACONIC_SCENE_REAL}: use double or single")
endif()

set(scene_folder "${CMAKE_BINARY_DIR}/scene")
set(scene_files "${scene_folder}/laconic_scene.h" "${scene_folder}/laconic_scene_model.h"
    "${scene_folder}/laconic_scene_model.c")
cmake_path(GET LACONIC_VENV PARENT_PATH host_build)
file(GLOB_RECURSE trim_program CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/python/laconic/core/*.py"
    "${PROJECT_SOURCE_DIR}/python/laconic/scene/*.py" "${PROJECT_SOURCE_DIR}/python/laconic/simulation/*.py"
    "${PROJECT_SOURCE_DIR}/python/laconic/tools/trim/*.py")
add_custom_command(
    OUTPUT ${scene_files}
    COMMAND "${CMAKE_COMMAND}" -E env "LACONIC_BUILD_DIR=${host_build}"
            "${LACONIC_COMMAND}" trim "${scene_file}" --real ${scene_real} --out "${scene_folder}"
    COMMAND "${CMAKE_COMMAND}" -E touch ${scene_files}
    DEPENDS "${scene_file}" ${trim_program}
    COMMENT "The core for ${LACONIC_SCENE}, ${scene_real}" VERBATIM)
add_custom_target(laconic_scene_files DEPENDS ${scene_files})
add_dependencies(laconic_scene_files laconic_venv)
if(venv_is_ours AND NOT CMAKE_CROSSCOMPILING)
    add_dependencies(laconic_scene_files laconic_shared_${scene_real} laconic_cdef_${scene_real})
endif()

file(GLOB_RECURSE scene_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/core_c/src/*.c"
    "${PROJECT_SOURCE_DIR}/core_c/optional/articulated/*.c")
include("${PROJECT_SOURCE_DIR}/core_c/cmake/LaconicCore.cmake")
add_library(laconic_scene STATIC ${scene_sources} "${scene_folder}/laconic_scene_model.c")
laconic_strict(laconic_scene)
target_include_directories(laconic_scene PUBLIC "${PROJECT_SOURCE_DIR}/core_c/include" "${scene_folder}"
    PRIVATE ${core_folders} "${PROJECT_SOURCE_DIR}/core_c/optional/articulated")
target_compile_definitions(laconic_scene PUBLIC LACONIC_SCENE_HEADER="laconic_scene.h")
if(scene_real STREQUAL "single")
    target_compile_definitions(laconic_scene PUBLIC LACONIC_SINGLE)
else()
    laconic_soft_double(laconic_scene)
endif()
set_target_properties(laconic_scene PROPERTIES ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
add_dependencies(laconic_scene laconic_scene_files)
