# What the whole project makes of the core besides the library: shared libraries for Python, the header's declarations for
# cffi (preprocessed, without the compiler's own headers), the check of purity, the tests.

# How the preprocessor makes declarations for cffi, which knows the standard types: the compiler's headers are empty.
set(empty_headers "${CMAKE_BINARY_DIR}/core_c/empty_headers")
foreach(header float stdbool stddef stdint)
    file(CONFIGURE OUTPUT "${empty_headers}/${header}.h" CONTENT "")
endforeach()
set(LACONIC_CDEF_FLAGS -E -P -nostdinc -DLACONIC_CDEF -I "${empty_headers}" CACHE INTERNAL "Also for the node's library")

function(laconic_development real)
    add_library(laconic_shared_${real} SHARED $<TARGET_OBJECTS:laconic_objects_${real}>)
    target_include_directories(laconic_shared_${real} PUBLIC include)
    target_compile_definitions(laconic_shared_${real} PUBLIC $<$<STREQUAL:${real},single>:LACONIC_SINGLE>)
    laconic_names(laconic_shared_${real} ${real})
    foreach(library laconic_core_${real} laconic_shared_${real})
        laconic_instrument(${library})
    endforeach()
    set_target_properties(laconic_shared_${real} PROPERTIES OUTPUT_NAME laconic_${real}
        LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib" RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")

    set(cdef "${CMAKE_BINARY_DIR}/lib/laconic_cdef_${real}.h")
    add_custom_command(
        OUTPUT "${cdef}"
        COMMAND "${CMAKE_C_COMPILER}" ${LACONIC_CDEF_FLAGS} $<$<STREQUAL:${real},single>:-DLACONIC_SINGLE>
                -I "${CMAKE_CURRENT_SOURCE_DIR}/include" "${CMAKE_CURRENT_SOURCE_DIR}/cdef.h" -o "${cdef}"
        DEPENDS ${core_headers} "${CMAKE_CURRENT_SOURCE_DIR}/cdef.h" COMMAND_EXPAND_LISTS VERBATIM)
    laconic_declarations(laconic_cdef_${real} "${cdef}")
    if(real STREQUAL "double") # the list of methods, for an installed package that has this build tree alone
        configure_file(include/laconic/methods.h "${CMAKE_BINARY_DIR}/lib/laconic_methods.h" COPYONLY)
    endif()
    laconic_purity(${real})
endfunction()
