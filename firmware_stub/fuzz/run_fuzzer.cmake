# Replays the kept corpus, then libFuzzer tries inputs of its own until RUNS have run: the same ones each time, since
# nothing hangs on the clock, on what was found before, or on the order in which a folder lists its files.
file(REMOVE_RECURSE "${FRESH}")
file(MAKE_DIRECTORY "${FRESH}")
file(GLOB kept LIST_DIRECTORIES FALSE "${CORPUS}/*") # in the order of their names
list(JOIN kept "," seeds)
file(WRITE "${FRESH}.seeds" "${seeds}")
execute_process(
    COMMAND "${PROGRAM}" -seed=1 -runs=${RUNS} -reload=0 -timeout=20 -max_len=${BYTES} -rss_limit_mb=1024
            -print_final_stats=1 "-seed_inputs=@${FRESH}.seeds" "-artifact_prefix=${FRESH}/" "${FRESH}"
    RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the fuzzer has found a fault: see the file that it names above, in ${FRESH}")
endif()
