# laconic_strict(<target>): the warnings we keep clean, and the arithmetic that gives the same bits everywhere.
#
# -ffp-contract=off alone is not enough: gcc 12's SLP vectoriser fuses multiply-add in spite of it.

set(LACONIC_ARITHMETIC_FLAGS -ffp-contract=off -fno-tree-slp-vectorize)
set(LACONIC_WARNING_FLAGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion)
if(LACONIC_WERROR)
    list(APPEND LACONIC_WARNING_FLAGS -Werror)
endif()

function(laconic_strict target)
    target_compile_options(${target} PRIVATE ${LACONIC_WARNING_FLAGS} ${LACONIC_ARITHMETIC_FLAGS})
    laconic_instrument(${target})
endfunction()

# Sanitizers and coverage, when asked for; for targets that are not ours to be strict with (Unity).
function(laconic_instrument target)
    if(LACONIC_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${LACONIC_SANITIZE} -fno-sanitize-recover=all -g)
        target_link_options(${target} PUBLIC -fsanitize=${LACONIC_SANITIZE})
    endif()
    if(LACONIC_COVERAGE)
        target_compile_definitions(${target} PRIVATE LACONIC_PLAIN_INLINE)
        target_compile_options(${target} PRIVATE --coverage -O0 -g)
        target_link_options(${target} PUBLIC --coverage)
    endif()
endfunction()
