# SPDX-License-Identifier: BSD-3-Clause
# `cmake --install build` and, from it, `cd build && cpack -G DEB`: programs, the jar for lcm-spy when it was built, message types,
# completion, docs. Nothing is built for it that `./shoal build` does not build.
include(GNUInstallDirs)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY TRUE)

install(TARGETS robot_agent fusion_node operator_console RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/shoal-spy DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${PROJECT_BINARY_DIR}/share/shoal/shoal_types.jar DESTINATION ${CMAKE_INSTALL_DATADIR}/shoal OPTIONAL)
install(DIRECTORY lcmtypes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/shoal/lcmtypes FILES_MATCHING PATTERN "*.lcm")
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/shoal)
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/shoal)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/shoal RENAME copyright)  # where Debian looks

# What the console itself says completes it.
set(completion ${PROJECT_BINARY_DIR}/completion)
install(CODE "
  file(MAKE_DIRECTORY ${completion})
  foreach(shell bash zsh)
    execute_process(COMMAND $<TARGET_FILE:operator_console> completion \${shell} OUTPUT_FILE ${completion}/\${shell}
                    COMMAND_ERROR_IS_FATAL ANY)
  endforeach()")
install(FILES ${completion}/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME operator_console)
install(FILES ${completion}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _operator_console)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME shoal)
set(CPACK_PACKAGE_CONTACT "the Shoal authors <shoal@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "multi-robot distributed semantic mapping over a thin link")
set(CPACK_PACKAGE_DESCRIPTION
    "Robots learn labels without classes, tell each other under a byte budget over LCM, and agree on one map.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin, python3")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "openjdk-17-jre, liblcm-java, libjchart2d-java")
include(CPack)
