# -DLACONIC_PEERS=ON: the programs that `laconic report` compares speed with, in build/peers, apart from the
# environment that everything else uses; a path file in it makes them importable, after all else. SUNDIALS CVODE comes
# from the system (Debian: libsundials-dev).
set(peers_lock "${PROJECT_SOURCE_DIR}/host_tests/requirements-peers.txt")
set(peers_stamp "${CMAKE_BINARY_DIR}/peers/laconic.stamp")
add_custom_command(
    OUTPUT "${peers_stamp}"
    COMMAND "${LACONIC_PYTHON}" -m pip install --quiet --no-input --require-hashes --no-deps --upgrade
            --target "${CMAKE_BINARY_DIR}/peers" -r "${peers_lock}"
    COMMAND "${LACONIC_PYTHON}" "${PROJECT_SOURCE_DIR}/cmake/add_to_path.py" "${CMAKE_BINARY_DIR}/peers"
    COMMAND "${CMAKE_COMMAND}" -E touch "${peers_stamp}"
    DEPENDS "${peers_lock}"
    COMMENT "Other integrators to compare with" USES_TERMINAL VERBATIM)
add_custom_target(laconic_peers ALL DEPENDS "${peers_stamp}")
add_dependencies(laconic_peers laconic_venv)
