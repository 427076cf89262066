# Whether there is a clang with libFuzzer: has_libfuzzer, and fuzz_compiler, which fuzz targets are compiled by; without it
# the project's own compiler, and fuzz_main replays a corpus. Looked for once.

find_program(LACONIC_CLANG clang)
if(NOT DEFINED CACHE{LACONIC_HAS_LIBFUZZER})
    set(probe "${PROJECT_BINARY_DIR}/CMakeFiles/libfuzzer_probe")
    set(works FALSE)
    if(LACONIC_CLANG)
        file(WRITE "${probe}.c" "int LLVMFuzzerTestOneInput(const char *d, unsigned long n);\nint LLVMFuzzerTestOneInput(const char *d, unsigned long n) { return d == 0 && n; }\n")
        execute_process(COMMAND "${LACONIC_CLANG}" -fsanitize=fuzzer,address,undefined "${probe}.c" -o "${probe}"
            RESULT_VARIABLE probe_failed OUTPUT_QUIET ERROR_QUIET)
        if(NOT probe_failed)
            set(works TRUE)
        endif()
    endif()
    set(LACONIC_HAS_LIBFUZZER ${works} CACHE INTERNAL "clang has libFuzzer")
    if(NOT works)
        message(STATUS "laconic: no clang with libFuzzer: the fuzz corpus is replayed, not extended")
    endif()
endif()
set(has_libfuzzer ${LACONIC_HAS_LIBFUZZER})
if(has_libfuzzer)
    # Without watching comparisons, which takes two thirds of the time: what matters in an input is a byte that chooses.
    # Without the depth of the stack, which differs by where the stack begins, so that runs would, too.
    set(fuzz_compiler "${LACONIC_CLANG}" -fsanitize=fuzzer,address,undefined -fno-sanitize-coverage=trace-cmp,stack-depth)
    set(fuzz_main "")
else()
    set(fuzz_compiler "${CMAKE_C_COMPILER}" -fsanitize=address,undefined)
    set(fuzz_main "${PROJECT_SOURCE_DIR}/firmware_stub/fuzz/replay_main.c")
endif()
list(APPEND fuzz_compiler -fno-sanitize-recover=all -std=c99 -O2 -g -ffp-contract=off)
set(fuzz_runner "${PROJECT_SOURCE_DIR}/firmware_stub/fuzz/run_fuzzer.cmake")

# What firmware_stub/fuzz/targets.txt says of a target, in a row.
set(fuzz_targets "${PROJECT_SOURCE_DIR}/firmware_stub/fuzz/targets.txt")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${fuzz_targets}")
function(laconic_fuzz_row target row)
    file(STRINGS "${fuzz_targets}" line REGEX "^${target} ")
    separate_arguments(line)
    set(${row} ${line} PARENT_SCOPE)
endfunction()

# laconic_fuzz_test(<target> <program>): replays the corpus; where libFuzzer is, it goes on until the row's executions
# have been, the same ones each time. What searches longer is `laconic soak fuzz`.
function(laconic_fuzz_test target program)
    laconic_fuzz_row(${target} row)
    list(GET row 1 bytes)
    list(GET row 2 runs)
    list(GET row 4 corpus)
    set(corpus "${PROJECT_SOURCE_DIR}/${corpus}")
    if(has_libfuzzer)
        add_test(NAME fuzz_${target} COMMAND "${CMAKE_COMMAND}" -DPROGRAM=${program} -DBYTES=${bytes} -DRUNS=${runs}
            -DFRESH=${PROJECT_BINARY_DIR}/fuzz/test/${target} -DCORPUS=${corpus} -P "${fuzz_runner}")
    else()
        add_test(NAME fuzz_${target} COMMAND "${program}" "${corpus}")
    endif()
    set_tests_properties(fuzz_${target} PROPERTIES TIMEOUT 300 LABELS fuzz COST 6)
endfunction()
