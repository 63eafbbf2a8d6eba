# What `cmake --install` lays down: the library and headers, the cde command, the RTL and the bitstream builder (which
# expects rtl/ beside verilator/), the default bitstreams, and the package for find_package(cde).
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cde)

install(TARGETS cde EXPORT cdeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS cde_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY host/include/cde DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY rtl DESTINATION ${CMAKE_INSTALL_DATADIR}/cde FILES_MATCHING PATTERN *.sv PATTERN *.svh)
install(DIRECTORY verilator DESTINATION ${CMAKE_INSTALL_DATADIR}/cde USE_SOURCE_PERMISSIONS
  PATTERN CMakeLists.txt EXCLUDE)
install(FILES ${PROJECT_BINARY_DIR}/toolchain DESTINATION ${CMAKE_INSTALL_DATADIR}/cde/verilator)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR})  # manual pages and completions
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
get_property(default_bitstreams GLOBAL PROPERTY CDE_DEFAULT_BITSTREAM_FILES)
install(FILES ${default_bitstreams} DESTINATION ${CMAKE_INSTALL_LIBDIR}/cde/bitstreams)

install(EXPORT cdeTargets NAMESPACE cde:: DESTINATION ${package_dir})
configure_package_config_file(cmake/cdeConfig.cmake.in ${PROJECT_BINARY_DIR}/cdeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cdeConfig.cmake ${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake DESTINATION ${package_dir})
