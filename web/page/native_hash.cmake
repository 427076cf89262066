# Runs PROGRAM and writes what it printed to OUT.
execute_process(COMMAND "${PROGRAM}" OUTPUT_FILE "${OUT}" COMMAND_ERROR_IS_FATAL ANY)
