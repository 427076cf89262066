# The Python environment and its interpreter LACONIC_PYTHON. Target `laconic_venv`: what the main job imports
# (python/requirements-demo.txt) and our own packages, editable. Target `laconic_venv_all`: also what all commands and
# tests import (python/requirements.txt), in the same environment.
#
# Depend on the targets, not on the stamp files: Make would run the rule once in every target that names the file. The
# targets belong to the top folder, so that Make begins with them: C that does not need them is compiled meanwhile. A
# build tree whose LACONIC_VENV lies in another tree only uses that environment; the other tree keeps it up to date.

find_package(Python3 3.10 COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
    message(FATAL_ERROR "laconic: no Python 3.10 or newer was found: install one, or name it with -DPython3_EXECUTABLE=")
endif()

if(CMAKE_HOST_WIN32)
    set(LACONIC_VENV_BIN "${LACONIC_VENV}/Scripts")
else()
    set(LACONIC_VENV_BIN "${LACONIC_VENV}/bin")
endif()
set(LACONIC_PYTHON "${LACONIC_VENV_BIN}/python${CMAKE_EXECUTABLE_SUFFIX}")
set(LACONIC_COMMAND "${LACONIC_VENV_BIN}/laconic${CMAKE_EXECUTABLE_SUFFIX}")
set(LACONIC_VENV_STAMP "${LACONIC_VENV}/laconic.stamp")

set(all_stamp "${LACONIC_VENV}/all.stamp")
set(python "${PROJECT_SOURCE_DIR}/python")
set(own_packages "${python}" "${PROJECT_SOURCE_DIR}/packaging")
set(own_projects ${own_packages})
list(TRANSFORM own_projects APPEND "/pyproject.toml")
# rewritten, and the packages installed anew, only when the version changes: it stands in their metadata
set(version_file "${CMAKE_BINARY_DIR}/python-version.txt")
file(CONFIGURE OUTPUT "${version_file}" CONTENT "${PROJECT_VERSION}\n")
cmake_path(IS_PREFIX CMAKE_BINARY_DIR "${LACONIC_VENV}" NORMALIZE venv_is_ours)
add_custom_target(laconic_venv_pip) # pip alone: enough to fetch what the C tests need while the packages are installed
if(venv_is_ours)
    add_custom_command(
        OUTPUT "${LACONIC_VENV}/pip.stamp"
        COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/cmake/make_venv.py" --venv "${LACONIC_VENV}"
                --stamp "${LACONIC_VENV}/pip.stamp"
        COMMENT "Python environment: pip" VERBATIM)
    add_custom_target(laconic_venv_begun DEPENDS "${LACONIC_VENV}/pip.stamp")
    add_dependencies(laconic_venv_pip laconic_venv_begun)
    add_custom_command(
        OUTPUT "${LACONIC_VENV_STAMP}"
        COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/cmake/make_venv.py" --venv "${LACONIC_VENV}"
                --requirements "${python}/requirements-demo.txt" --packages ${own_packages} --stamp "${LACONIC_VENV_STAMP}"
        DEPENDS "${PROJECT_SOURCE_DIR}/cmake/make_venv.py" "${python}/requirements-demo.txt" ${own_projects}
                "${version_file}"
        COMMENT "Python environment of the main job" VERBATIM)
    add_custom_command(
        OUTPUT "${all_stamp}"
        COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/cmake/make_venv.py" --venv "${LACONIC_VENV}"
                --requirements "${python}/requirements.txt" --stamp "${all_stamp}"
        DEPENDS "${PROJECT_SOURCE_DIR}/cmake/make_venv.py" "${python}/requirements.txt" "${LACONIC_VENV_STAMP}"
        COMMENT "Python environment of all commands and tests" VERBATIM)
elseif(NOT EXISTS "${LACONIC_VENV_STAMP}")
    message(FATAL_ERROR "laconic: LACONIC_VENV=${LACONIC_VENV} does not exist: build the tree that it belongs to first")
endif()
add_custom_target(laconic_venv ALL DEPENDS "${LACONIC_VENV_STAMP}")
add_dependencies(laconic_venv laconic_venv_pip)
add_custom_target(laconic_venv_all ALL DEPENDS "${all_stamp}")
add_dependencies(laconic_venv_all laconic_venv)

# -DLACONIC_PEERS=ON: the programs that `laconic report` compares speed with, in build/peers, apart from the
# environment that everything else uses; a path file in it makes them importable, after all else. SUNDIALS CVODE comes
# from the system (Debian: libsundials-dev).
if(LACONIC_PEERS)
    set(peers_lock "${PROJECT_SOURCE_DIR}/host_tests/requirements-peers.txt")
    set(peers_stamp "${CMAKE_BINARY_DIR}/peers/laconic.stamp")
    string(CONCAT name_peers "import pathlib, sysconfig; pathlib.Path(sysconfig.get_path('purelib'), 'laconic_peers.pth')"
                             ".write_text(r'${CMAKE_BINARY_DIR}/peers' + '\\n', encoding='utf-8')")
    add_custom_command(
        OUTPUT "${peers_stamp}"
        COMMAND "${LACONIC_PYTHON}" -m pip install --quiet --no-input --require-hashes --no-deps --upgrade
                --target "${CMAKE_BINARY_DIR}/peers" -r "${peers_lock}"
        COMMAND "${LACONIC_PYTHON}" -c "${name_peers}"
        COMMAND "${CMAKE_COMMAND}" -E touch "${peers_stamp}"
        DEPENDS "${peers_lock}"
        COMMENT "Other integrators to compare with" USES_TERMINAL VERBATIM)
    add_custom_target(laconic_peers ALL DEPENDS "${peers_stamp}")
    add_dependencies(laconic_peers laconic_venv)
endif()

# laconic_declarations(<target> <header>): the header's declarations, as the tables of cffi beside it (….py).
function(laconic_declarations target header)
    cmake_path(REPLACE_EXTENSION header LAST_ONLY py OUTPUT_VARIABLE tables)
    set(packaging "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../packaging")
    add_custom_command(
        OUTPUT "${tables}"
        COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${packaging}" PYTHONDONTWRITEBYTECODE=1
                "${LACONIC_PYTHON}" -m laconic_build.c declarations "${header}"
        DEPENDS "${header}" "${packaging}/laconic_build/c/__main__.py"
        COMMENT "Declarations for Python: ${target}" VERBATIM)
    add_custom_target(${target} ALL DEPENDS "${tables}")
    add_dependencies(${target} laconic_venv)
endfunction()
