# Runs PROGRAM and writes what it printed to OUT, in a folder that Make does not make by itself.
cmake_path(GET OUT PARENT_PATH folder)
file(MAKE_DIRECTORY "${folder}")
execute_process(COMMAND "${PROGRAM}" OUTPUT_FILE "${OUT}" COMMAND_ERROR_IS_FATAL ANY)
