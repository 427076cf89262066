# Replays the kept corpus, then lets libFuzzer add to a folder of the build tree for SECONDS seconds.
file(MAKE_DIRECTORY "${FRESH}")
execute_process(
    COMMAND "${PROGRAM}" -max_total_time=${SECONDS} -max_len=2000 -rss_limit_mb=1024 -print_final_stats=1
            "-artifact_prefix=${FRESH}/" "${FRESH}" "${CORPUS}"
    RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the fuzzer has found something: see the file it names in ${FRESH}")
endif()
