# What `cmake --install` gives: headers, libraries, the CMake package `Burnish` with its target Burnish::burnish, the program,
# its manual page and shell completions. Of a portable build the program alone, with what it loads.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Burnish)

install(TARGETS burnish_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET burnish_mpi_program)
    install(TARGETS burnish_mpi_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(TARGETS burnish EXPORT BurnishTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
# The library of a portable build shows one function, for the program: no other program can link it.
if(NOT BURNISH_PORTABLE)
    install(DIRECTORY include/burnish DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    install(EXPORT BurnishTargets NAMESPACE Burnish:: DESTINATION ${package_dir})
    # Apart: who does not ask for the component needs no MPI.
    if(TARGET burnish_mpi)
        install(TARGETS burnish_mpi EXPORT BurnishMpiTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
        install(EXPORT BurnishMpiTargets NAMESPACE Burnish:: DESTINATION ${package_dir})
    endif()
    configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/BurnishConfig.cmake.in ${CMAKE_BINARY_DIR}/BurnishConfig.cmake
        INSTALL_DESTINATION ${package_dir})
    write_basic_package_version_file(${CMAKE_BINARY_DIR}/BurnishConfigVersion.cmake COMPATIBILITY SameMinorVersion)
    install(FILES ${CMAKE_BINARY_DIR}/BurnishConfig.cmake ${CMAKE_BINARY_DIR}/BurnishConfigVersion.cmake
        DESTINATION ${package_dir})
endif()

# The manual page and the completions are made of what the program says of itself.
set(documents ${CMAKE_BINARY_DIR}/documents)
add_custom_command(OUTPUT ${documents}/burnish.1 ${documents}/burnish.bash ${documents}/_burnish ${documents}/burnish.fish
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/scripts/document_program.sh $<TARGET_FILE:burnish_program> ${documents}
    DEPENDS burnish_program ${CMAKE_CURRENT_SOURCE_DIR}/scripts/document_program.sh
    COMMENT "Writing the manual page and shell completions" VERBATIM)
add_custom_target(burnish_documents ALL DEPENDS ${documents}/burnish.1)
install(FILES ${documents}/burnish.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${documents}/burnish.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME burnish)
install(FILES ${documents}/_burnish DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${documents}/burnish.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
