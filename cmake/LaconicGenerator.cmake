# CMake's default generator is Make. Where only Ninja is installed, the message names the remedy; CMake's own does not.
find_program(LACONIC_MAKE NAMES make gmake)
find_program(LACONIC_NINJA NAMES ninja ninja-build)
mark_as_advanced(LACONIC_MAKE LACONIC_NINJA)
if(CMAKE_GENERATOR STREQUAL "Unix Makefiles" AND NOT LACONIC_MAKE AND NOT CMAKE_MAKE_PROGRAM)
    if(LACONIC_NINJA)
        message(FATAL_ERROR "laconic: there is Ninja but no Make: remove the build folder, set CMAKE_GENERATOR=Ninja in "
                            "the environment, and give the same command again")
    endif()
    message(FATAL_ERROR "laconic: neither Make nor Ninja was found: install one of them")
endif()
