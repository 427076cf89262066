# What must be known of the core before it is compiled: its version and its folders.

# LACONIC_VERSION: the version, which stands once, in laconic.h.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../include/laconic/laconic.h" laconic_version_line REGEX "^#define LACONIC_VERSION ")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" LACONIC_VERSION "${laconic_version_line}")

# core_folders: where the core's own headers are. A file includes another by its name alone, so that the core also
# compiles from one flat folder, as source FMUs and packages of embedded tools have it.

get_filename_component(core_source_folder "${CMAKE_CURRENT_LIST_DIR}/../src" ABSOLUTE)
set(core_folders common math vehicle methods friction state sensors)
list(TRANSFORM core_folders PREPEND "${core_source_folder}/")
