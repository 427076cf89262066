# LACONIC_VERSION: the version, which stands once, in laconic.h.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../include/laconic/laconic.h" laconic_version_line REGEX "^#define LACONIC_VERSION ")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" LACONIC_VERSION "${laconic_version_line}")
