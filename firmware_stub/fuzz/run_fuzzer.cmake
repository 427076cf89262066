# Replays the kept corpus, then libFuzzer searches for SECONDS seconds and keeps new inputs in a folder of the build
# tree.
file(MAKE_DIRECTORY "${FRESH}")
execute_process(
    COMMAND "${PROGRAM}" -max_total_time=${SECONDS} -max_len=${BYTES} -rss_limit_mb=1024 -print_final_stats=1
            "-artifact_prefix=${FRESH}/" "${FRESH}" "${CORPUS}"
    RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the fuzzer has found a fault: see the file that it names above, in ${FRESH}")
endif()
