# laconic_strict(<target>): warnings, which must not occur, arithmetic that gives the same bits everywhere, and a
# section for each function and table.

include("${CMAKE_CURRENT_LIST_DIR}/../core_c/cmake/LaconicArithmetic.cmake")
set(LACONIC_WARNING_FLAGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion)
if(LACONIC_WERROR)
    list(APPEND LACONIC_WARNING_FLAGS -Werror)
endif()

function(laconic_strict target)
    target_compile_options(${target} PRIVATE ${LACONIC_WARNING_FLAGS})
    laconic_arithmetic(${target})
    get_target_property(kind ${target} TYPE)
    if(CMAKE_EXECUTABLE_FORMAT STREQUAL "ELF" AND kind MATCHES "EXECUTABLE|SHARED_LIBRARY|MODULE_LIBRARY")
        target_link_options(${target} PRIVATE -Wl,--gc-sections)
    endif()
    laconic_instrument(${target})
endfunction()

# clang from 18 on counts lines, branches and the conditions of each decision (MC/DC), other compilers lines and
# branches: not by --coverage, which a file's own options could not take back.
if(CMAKE_C_COMPILER_ID STREQUAL "Clang" AND CMAKE_C_COMPILER_VERSION VERSION_GREATER_EQUAL 18)
    set(LACONIC_COVERAGE_FLAGS -fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc)
    set(LACONIC_NO_COVERAGE_FLAGS -fno-profile-instr-generate -fno-coverage-mapping -fno-coverage-mcdc)
    set(LACONIC_COVERAGE_LINK_FLAGS -fprofile-instr-generate)
else()
    set(LACONIC_COVERAGE_FLAGS -fprofile-arcs -ftest-coverage)
    set(LACONIC_NO_COVERAGE_FLAGS -fno-profile-arcs -fno-test-coverage)
    set(LACONIC_COVERAGE_LINK_FLAGS --coverage)
endif()

# Without it clang takes an array at the end of a struct for one of any length, whose bounds its sanitizer leaves alone.
include(CheckCCompilerFlag)
check_c_compiler_flag(-fstrict-flex-arrays=3 LACONIC_HAS_STRICT_ARRAYS)
if(LACONIC_HAS_STRICT_ARRAYS)
    set(LACONIC_STRICT_ARRAYS -fstrict-flex-arrays=3)
endif()

# Part of no group of sanitizers, in gcc and clang: a number beyond the range of an integer it is converted to.
if(LACONIC_SANITIZE MATCHES "undefined")
    set(LACONIC_SANITIZE_CASTS -fsanitize=float-cast-overflow)
endif()

# Sanitizers and coverage where LACONIC_SANITIZE and LACONIC_COVERAGE set them, also for code that is not ours.
function(laconic_instrument target)
    if(LACONIC_SANITIZE)
        # -O0: sanitizers see every access, none that was optimised away, and gcc takes a tenth of the time for the
        # lanes of a batch.
        target_compile_options(${target} PRIVATE -fsanitize=${LACONIC_SANITIZE} ${LACONIC_SANITIZE_CASTS}
            -fno-sanitize-recover=all -O0 -g ${LACONIC_STRICT_ARRAYS})
        target_link_options(${target} PUBLIC -fsanitize=${LACONIC_SANITIZE})
    endif()
    if(LACONIC_COVERAGE)
        target_compile_definitions(${target} PRIVATE LACONIC_PLAIN_INLINE)
        target_compile_options(${target} PRIVATE ${LACONIC_COVERAGE_FLAGS} -O0 -g)
        target_link_options(${target} PUBLIC ${LACONIC_COVERAGE_LINK_FLAGS})
    endif()
endfunction()
