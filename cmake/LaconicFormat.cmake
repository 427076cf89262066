# Target `c_format` formats all C files with the locked clang-format; the test `c_style` fails if one is not formatted.

file(GLOB_RECURSE c_files CONFIGURE_DEPENDS
    "${PROJECT_SOURCE_DIR}/core_c/*.[ch]" "${PROJECT_SOURCE_DIR}/fmu/*.[ch]" "${PROJECT_SOURCE_DIR}/firmware_stub/*.[ch]"
    "${PROJECT_SOURCE_DIR}/web/npm/*.[ch]")
add_custom_target(c_format COMMAND "${LACONIC_VENV_BIN}/clang-format" -i ${c_files} VERBATIM)
add_dependencies(c_format laconic_venv)
if(BUILD_TESTING)
    add_test(NAME c_style COMMAND "${LACONIC_VENV_BIN}/clang-format" --dry-run --Werror ${c_files})
endif()
