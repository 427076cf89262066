# What .ci/run and .ci/nightly share: installing what a bare Debian or Ubuntu lacks, gates, second build trees. Every gate
# runs even when an earlier one failed; the last lines name those that failed and count the tests.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2
export PIP_DISABLE_PIP_VERSION_CHECK=1
export failed_gates
failed_gates=$(mktemp)
trap 'rm -f "$failed_gates"' EXIT

install_missing() {
    local packages=()
    lacks() { command -v "$1" >/dev/null || packages+=("${@:2}"); }
    lacks cmake cmake
    lacks make make
    lacks ninja ninja-build # takes a minute less than Make for so many small programs
    lacks gcc gcc libc6-dev
    lacks g++ g++
    lacks pkg-config pkg-config
    lacks clang clang
    lacks git git
    lacks wasm-ld lld # for the core as WebAssembly
    lacks node nodejs
    lacks tsc node-typescript # for the types of the npm package
    lacks chromedriver chromium chromium-driver # for the page
    lacks python3 python3 python3-venv
    lacks valgrind valgrind
    lacks cppcheck cppcheck
    lacks clang-tidy clang-tidy
    lacks arm-none-eabi-gcc gcc-arm-none-eabi libnewlib-arm-none-eabi
    lacks qemu-system-arm qemu-system-arm
    python3 -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
    [ -e /usr/include/cvode/cvode.h ] || packages+=(libsundials-dev)
    ldconfig -p 2>/dev/null | grep -q libtbb.so.12 || packages+=(libtbb12) # for ecospy, an importer in the FMU tests
    install "${packages[@]}"
    # clang's run-time for sanitizers and fuzzing is a package of its own, named after clang's version
    if command -v clang >/dev/null &&
        ! echo 'int main(void){return 0;}' | clang -fsanitize=address,undefined -x c - -o /dev/null 2>/dev/null; then
        install "libclang-rt-$(clang -dumpversion | cut -d. -f1)-dev"
    fi
}

install() {
    [ $# -eq 0 ] && return 0
    command -v apt-get >/dev/null || { echo "ci: install by hand: $*"; return 0; }
    echo "ci: installing $*"
    local as_root=(); [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    export DEBIAN_FRONTEND=noninteractive
    "${as_root[@]}" apt-get -qq update || true
    "${as_root[@]}" apt-get -qq -y install --no-install-recommends "$@" >/dev/null && return 0
    local package # one package that this distribution lacks must not keep the others away
    for package in "$@"; do
        "${as_root[@]}" apt-get -qq -y install --no-install-recommends "$package" >/dev/null ||
            echo "ci: $package cannot be installed"
    done
}

# gate NAME COMMAND…: runs it, shows how long it took, remembers when it failed
gate() {
    local name=$1 start=$SECONDS; shift
    printf '\n=== %s\n' "$name"
    if "$@"; then
        echo "=== $name: passed in $((SECONDS - start)) s"
    else
        echo "=== $name: FAILED after $((SECONDS - start)) s"
        echo "$name" >>"$failed_gates"
    fi
}

# gate_beside NAME COMMAND…: a gate while others run; what it prints comes in one piece, at its end
gate_beside() {
    echo "... begun: $1"
    local printed
    printed=$(gate "$@" 2>&1)
    printf '%s\n' "$printed"
}

# another_build FOLDER TARGETS OPTION…: a second build tree that shares the Python environment
another_build() {
    local folder=$1 targets; read -ra targets <<<"$2"; shift 2
    cmake -S . -B "$folder" -DLACONIC_VENV="$PWD/build/venv" "$@" >"$folder.log" 2>&1 &&
        cmake --build "$folder" -j2 --target "${targets[@]}" >>"$folder.log" 2>&1 || { tail -40 "$folder.log"; return 1; }
}

# make_debug TARGETS: these by Make, without optimisation
make_debug() {
    local -x CMAKE_GENERATOR="Unix Makefiles"
    another_build build-make "$1" -DCMAKE_BUILD_TYPE=Debug
}

# unity_tests FOLDER OPTION…: the C tests of a build tree; in full only when one fails
unity_tests() {
    ctest --test-dir "$1" -L unity -j2 --output-on-failure --no-tests=error --output-junit tests.xml "${@:2}" \
        >"$1.tests.log" 2>&1 || { tail -60 "$1.tests.log"; return 1; }
    grep 'tests passed' "$1.tests.log"
}

# sanitizers OPTION…: the C tests under the sanitizers for addresses and undefined behaviour, by clang, which
# has no warning about what ships: the tests compile it but for the FMUs of hinges
sanitizers() {
    local options=(-DLACONIC_SANITIZE=address,undefined -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=Debug)
    command -v ld.lld >/dev/null && # takes half of the time for programs with sanitizers
        options+=(-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld)
    another_build build-checked "laconic_unity_tests LaconicArticulated_fmi3 LaconicSlipping_fmi3 laconic_node" \
        "${options[@]}" && unity_tests build-checked "$@"
}

# two_at_a_time NAME FUNCTION NAME FUNCTION…: gates beside each other, in this order; the next begins when one ends
two_at_a_time() {
    local functions
    mapfile -t functions < <(compgen -A function)
    export -f "${functions[@]}"
    printf '%s\0' "$@" | xargs -0 -n 2 -P 2 bash -uo pipefail -c 'gate_beside "$0" "$1"'
}

count_tests() {
    build/venv/bin/python - build*/tests.xml build/pytest/*.xml <<'END'
import sys
from pathlib import Path
from xml.etree import ElementTree

passed = failed = skipped = 0
for path in map(Path, sys.argv[1:]):
    for suite in ElementTree.parse(path).iter("testsuite") if path.exists() else []:
        count = {key: int(suite.get(key, 0)) for key in ("tests", "failures", "errors", "skipped", "disabled")}
        bad, left_out = count["failures"] + count["errors"], count["skipped"] + count["disabled"]
        passed, failed, skipped = passed + count["tests"] - bad - left_out, failed + bad, skipped + left_out
print(f"{passed} passed, {failed} failed, {skipped} skipped")
END
}

# report: how long it took, what failed, how many tests; its status is that of the script
report() {
    printf '\n=== all gates in %s s\n' "$SECONDS"
    [ -s "$failed_gates" ] && sed 's/^/failed: /' "$failed_gates"
    count_tests
    [ ! -s "$failed_gates" ]
}

install_missing
command -v ninja >/dev/null && export CMAKE_GENERATOR=Ninja
true
