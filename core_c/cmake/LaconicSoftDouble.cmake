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
