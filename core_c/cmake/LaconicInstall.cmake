# laconic_install(<targets>…): libraries, headers, the package for find_package(laconic) and the files of pkg-config, all
# of which find each other wherever the folder is moved to. Components: laconic_runtime (what a program loads) and
# laconic_development (what it is built with).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(laconic_templates "${CMAKE_CURRENT_LIST_DIR}")

function(laconic_install)
    install(TARGETS ${ARGN} EXPORT laconicTargets
        RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT laconic_runtime
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT laconic_runtime
            NAMELINK_COMPONENT laconic_development
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT laconic_development
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
    install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/include/laconic" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        COMPONENT laconic_development FILES_MATCHING PATTERN "*.h")
    install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/optional/soft_double" DESTINATION "${CMAKE_INSTALL_DATADIR}/laconic"
        COMPONENT laconic_development)
    set(package "${CMAKE_INSTALL_LIBDIR}/cmake/laconic")
    set(made "${CMAKE_CURRENT_BINARY_DIR}/package")
    install(EXPORT laconicTargets NAMESPACE laconic:: DESTINATION "${package}" COMPONENT laconic_development)
    configure_package_config_file("${laconic_templates}/laconicConfig.cmake.in"
        "${made}/laconicConfig.cmake" INSTALL_DESTINATION "${package}" NO_SET_AND_CHECK_MACRO)
    write_basic_package_version_file("${made}/laconicConfigVersion.cmake" VERSION ${LACONIC_VERSION}
        COMPATIBILITY SameMinorVersion) # as long as the major version is 0
    install(FILES "${made}/laconicConfig.cmake" "${made}/laconicConfigVersion.cmake" DESTINATION "${package}"
        COMPONENT laconic_development)
    foreach(target ${ARGN})
        laconic_pkg_config(${target} "${made}")
    endforeach()
    laconic_install_licence()
endfunction()

# <file of the library>.pc beside it: pkg-config knows by pcfiledir where it lies.
function(laconic_pkg_config target made)
    get_target_property(pc_name ${target} OUTPUT_NAME)
    get_target_property(pc_real ${target} INTERFACE_LACONIC_REAL)
    set(pc_definitions "")
    if(pc_real STREQUAL "single")
        set(pc_definitions " -DLACONIC_SINGLE")
    endif()
    set(folder "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
    foreach(kind LIBDIR INCLUDEDIR)
        if(IS_ABSOLUTE "${CMAKE_INSTALL_${kind}}")
            set(pc_${kind} "${CMAKE_INSTALL_${kind}}")
        else()
            file(RELATIVE_PATH beside "/prefix/${folder}" "/prefix/${CMAKE_INSTALL_${kind}}")
            string(REGEX REPLACE "/$" "" beside "${beside}")
            set(pc_${kind} "\${pcfiledir}/${beside}")
        endif()
    endforeach()
    configure_file("${laconic_templates}/laconic.pc.in" "${made}/${pc_name}.pc" @ONLY)
    install(FILES "${made}/${pc_name}.pc" DESTINATION "${folder}" COMPONENT laconic_development)
endfunction()

# In the project the licence is one folder higher, in the archive of the core alone beside it; where the folder was copied
# alone, it came another way.
function(laconic_install_licence)
    foreach(licence "${CMAKE_CURRENT_SOURCE_DIR}/LICENSE" "${CMAKE_CURRENT_SOURCE_DIR}/../LICENSE")
        if(EXISTS "${licence}")
            foreach(component laconic_runtime laconic_development)
                install(FILES "${licence}" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/laconic" COMPONENT ${component})
            endforeach()
            return()
        endif()
    endforeach()
endfunction()
