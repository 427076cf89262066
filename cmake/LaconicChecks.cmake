# What the build checks of C sources: their purity and their layout.

# laconic_purity(<real>): the build fails when the core's sources or objects are not pure (cmake/check_purity.py).
#
# Checked are the library and the same sources compiled for x86-64-v3, which has fused multiply-add instructions.
# Instrumented builds (sanitizers, coverage) call their run-time libraries, so they are not checked.

include(CheckCCompilerFlag)
find_program(LACONIC_OBJDUMP NAMES "${CMAKE_OBJDUMP}" objdump llvm-objdump)
find_program(LACONIC_NM NAMES "${CMAKE_NM}" nm llvm-nm)
mark_as_advanced(LACONIC_OBJDUMP LACONIC_NM)

function(laconic_purity real)
    if(NOT LACONIC_PURITY OR LACONIC_SANITIZE OR LACONIC_COVERAGE OR NOT CMAKE_EXECUTABLE_FORMAT STREQUAL "ELF")
        return()
    endif()
    if(NOT LACONIC_OBJDUMP OR NOT LACONIC_NM)
        message(WARNING "laconic: no nm or objdump found: the purity of the core is not checked")
        return()
    endif()
    set(objects $<TARGET_FILE:laconic_core_${real}>)
    check_c_compiler_flag(-march=x86-64-v3 LACONIC_CAN_BUILD_V3)
    if(LACONIC_CAN_BUILD_V3)
        add_library(laconic_core_${real}_v3 STATIC ${core_sources})
        laconic_strict(laconic_core_${real}_v3)
        target_compile_options(laconic_core_${real}_v3 PRIVATE -march=x86-64-v3)
        target_include_directories(laconic_core_${real}_v3 PRIVATE include ${core_folders} ${optional_folders})
        target_compile_definitions(laconic_core_${real}_v3 PRIVATE $<$<STREQUAL:${real},single>:LACONIC_SINGLE>)
        list(APPEND objects $<TARGET_FILE:laconic_core_${real}_v3>)
    endif()
    file(GLOB_RECURSE all_sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/src/*.[ch]"
        "${CMAKE_CURRENT_SOURCE_DIR}/optional/articulated/*.[ch]"
        "${CMAKE_CURRENT_SOURCE_DIR}/optional/articulated_friction/*.[ch]")
    set(check "${laconic_SOURCE_DIR}/cmake/check_purity.py")
    set(stamp "${CMAKE_CURRENT_BINARY_DIR}/pure_${real}.stamp")
    add_custom_command(
        OUTPUT "${stamp}"
        COMMAND "${Python3_EXECUTABLE}" "${check}" --sources ${all_sources} ${core_headers} --objects ${objects}
                --nm "${LACONIC_NM}" --objdump "${LACONIC_OBJDUMP}" --stamp "${stamp}"
        DEPENDS "${check}" ${all_sources} ${core_headers} ${objects}
        COMMENT "Purity of the core, ${real}" VERBATIM)
    add_custom_target(laconic_pure_${real} ALL DEPENDS "${stamp}")
endfunction()

# Target `c_format` formats all C files with the locked clang-format; the test `c_style` fails if one is not formatted.

file(GLOB_RECURSE c_files CONFIGURE_DEPENDS
    "${PROJECT_SOURCE_DIR}/core_c/*.[ch]" "${PROJECT_SOURCE_DIR}/fmu/*.[ch]" "${PROJECT_SOURCE_DIR}/firmware_stub/*.[ch]"
    "${PROJECT_SOURCE_DIR}/web/npm/*.[ch]")
add_custom_target(c_format COMMAND "${LACONIC_VENV_BIN}/clang-format" -i ${c_files} VERBATIM)
add_dependencies(c_format laconic_venv)
if(BUILD_TESTING)
    add_test(NAME c_style COMMAND "${LACONIC_VENV_BIN}/clang-format" --dry-run --Werror ${c_files})
    set_tests_properties(c_style PROPERTIES LABELS style)
endif()
