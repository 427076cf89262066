# Toolchain file for Cortex-M with Arm's GNU compiler: cmake --toolchain cmake/cortex_m.cmake -DLACONIC_CPU=cortex-m4 …
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # nothing to link a program against
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES LACONIC_CPU)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)

set(LACONIC_CPU cortex-m4 CACHE STRING "cortex-m0, cortex-m3, cortex-m4 (with FPU) or cortex-m7 (with double FPU)")
set(float_flags "-mfloat-abi=soft")
if(LACONIC_CPU STREQUAL "cortex-m4")
    set(float_flags "-mfloat-abi=hard -mfpu=fpv4-sp-d16")
elseif(LACONIC_CPU STREQUAL "cortex-m7")
    set(float_flags "-mfloat-abi=hard -mfpu=fpv5-d16")
endif()
set(CMAKE_C_FLAGS_INIT "-mthumb -mcpu=${LACONIC_CPU} ${float_flags}")
