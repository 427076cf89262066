# The README's C example, compiled unchanged and run; its output must be that in the README.

set(readme "${PROJECT_SOURCE_DIR}/README.md")
set(readme_script "${PROJECT_SOURCE_DIR}/cmake/readme_example.py")
set(readme_example "${CMAKE_BINARY_DIR}/readme/readme_example.c")
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/readme")
add_custom_command(
    OUTPUT "${readme_example}"
    COMMAND "${Python3_EXECUTABLE}" "${readme_script}" "${readme}" --write "${readme_example}"
    DEPENDS "${readme}" "${readme_script}"
    COMMENT "The README's example" VERBATIM)
add_executable(readme_example "${readme_example}")
target_compile_options(readme_example PRIVATE ${LACONIC_WARNING_FLAGS})
target_link_libraries(readme_example PRIVATE laconic_core_double)
add_test(NAME readme_example
    COMMAND "${Python3_EXECUTABLE}" "${readme_script}" "${readme}" --check $<TARGET_FILE:readme_example>)
