# laconic_arithmetic(<target>): the options of the core's own files that give the same bits everywhere, whatever options
# the project around it has, and a section for each function and table, so that the linker leaves out what a program
# does not call. Programs that use the core need none of them.
#
# -ffp-contract=off alone is not enough: gcc 12's SLP vectoriser fuses multiply-add in spite of it. -fno-fast-math takes
# back -ffast-math and -Ofast of a project around; options that it does not take back the core refuses (common.h).

set(LACONIC_ARITHMETIC_FLAGS -fno-fast-math -ffp-contract=off -fno-tree-slp-vectorize)
set(LACONIC_SECTION_FLAGS -ffunction-sections -fdata-sections)

function(laconic_arithmetic target)
    if(MSVC)
        target_compile_options(${target} PRIVATE /fp:precise)
    else()
        target_compile_options(${target} PRIVATE ${LACONIC_ARITHMETIC_FLAGS} ${LACONIC_SECTION_FLAGS})
    endif()
endfunction()

# laconic_soft_double(<target>): adds soft_double.c to a library in double precision where the processor has none and
# libgcc rounds some differences wrongly; the file's own conditions decide. docs/c.md explains it.

include(CheckCSourceCompiles)
set(laconic_soft_double_file "${CMAKE_CURRENT_LIST_DIR}/../optional/soft_double/soft_double.c")

function(laconic_soft_double target)
    if(MSVC)
        return()
    endif()
    set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # a bare processor has nothing to link a program with
    check_c_source_compiles("
        #include \"${laconic_soft_double_file}\"
        #ifndef LACONIC_SOFT_DOUBLE_REPLACES
        #error not needed
        #endif" LACONIC_NEEDS_SOFT_DOUBLE)
    if(LACONIC_NEEDS_SOFT_DOUBLE)
        target_sources(${target} PRIVATE "${laconic_soft_double_file}")
    endif()
endfunction()
