# laconic_arm_gcc_lacks(<variable>): the reason why LACONIC_ARM_GCC cannot build firmware, in one line; "" if it can.
#
# Distributions package the compiler, its C library (newlib, nano.specs) and the library's variants for each processor
# separately, so headers, the small library and linking are tried for each processor.

find_program(LACONIC_ARM_GCC arm-none-eabi-gcc)

set(arm_m0 -mcpu=cortex-m0)
set(arm_m3 -mcpu=cortex-m3)
set(arm_m4f -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16)
set(arm_m7 -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16)

function(laconic_arm_gcc_lacks variable)
    set(${variable} "" PARENT_SCOPE)
    if(NOT LACONIC_ARM_GCC)
        set(${variable} "no arm-none-eabi-gcc" PARENT_SCOPE)
        return()
    endif()
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/arm_gcc_probe")
    file(WRITE "${folder}/probe.c" "#include <stdint.h>\n#include <stdlib.h>\n#include <string.h>\n"
        "volatile double number = 1.0;\nchar from[9], to[9];\n"
        "void probe(void) { number /= 3.0; memcpy(to, from, (size_t)(uint8_t)number); }\n")
    foreach(cpu m0 m3 m4f m7)
        execute_process(
            COMMAND "${LACONIC_ARM_GCC}" -std=c99 -mthumb ${arm_${cpu}} --specs=nano.specs -nostartfiles -Wl,-e,probe
                    probe.c -o probe.elf
            WORKING_DIRECTORY "${folder}" RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
        if(NOT failed STREQUAL "0")
            string(REGEX MATCH "[^\n]*(error|cannot|No such)[^\n]*" first "${output}")
            set(${variable} "arm-none-eabi-gcc cannot link with newlib (${first}); install libnewlib-arm-none-eabi"
                PARENT_SCOPE)
            return()
        endif()
    endforeach()
endfunction()
