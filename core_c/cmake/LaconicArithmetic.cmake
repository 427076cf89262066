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
