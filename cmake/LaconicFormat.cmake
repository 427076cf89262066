# Targets `c_format` (lays out all C files) and `c_style` (fails where one is not laid out), by the locked clang-format.
# Public headers and tables of coefficients are set by hand, for reading.

file(GLOB_RECURSE c_files CONFIGURE_DEPENDS
    "${PROJECT_SOURCE_DIR}/core_c/*.c" "${PROJECT_SOURCE_DIR}/fmu/*.c" "${PROJECT_SOURCE_DIR}/firmware_stub/*.c")
add_custom_target(c_format COMMAND "${LACONIC_VENV_BIN}/clang-format" -i ${c_files} VERBATIM)
add_custom_target(c_style COMMAND "${LACONIC_VENV_BIN}/clang-format" --dry-run --Werror ${c_files} VERBATIM)
add_dependencies(c_format laconic_venv)
add_dependencies(c_style laconic_venv)
