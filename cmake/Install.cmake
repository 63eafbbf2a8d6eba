# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` lays down: the library and headers, the cde command, the RTL and the bitstream builder (which
# expects rtl/ beside verilator/), those of the default bitstreams that are built, and the package for find_package(cde).
# It works from any state of the build: the library and the command are built if they are not, the bitstreams, minutes of
# work that an installed cde does itself where it finds Verilator and clang, are not.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cde)
add_custom_target(cde_installed)
add_dependencies(cde_installed cde cde_cli)
install(CODE "
  if(NOT EXISTS \"$<TARGET_FILE:cde>\" OR NOT EXISTS \"$<TARGET_FILE:cde_cli>\")
    message(STATUS \"Not built yet: building the library and the command\")
    execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${CMAKE_BINARY_DIR}\" --target cde_installed COMMAND_ERROR_IS_FATAL ANY)
  endif()")

install(TARGETS cde EXPORT cdeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS cde_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY host/include/cde DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} PATTERN pipes EXCLUDE)  # mirror references of the pipes are for tests
install(DIRECTORY rtl DESTINATION ${CMAKE_INSTALL_DATADIR}/cde FILES_MATCHING PATTERN *.sv PATTERN *.svh PATTERN *.f)
install(DIRECTORY host/include/cde/contract DESTINATION ${CMAKE_INSTALL_DATADIR}/cde/host/include/cde)  # models are built with it
install(DIRECTORY verilator DESTINATION ${CMAKE_INSTALL_DATADIR}/cde USE_SOURCE_PERMISSIONS
  PATTERN CMakeLists.txt EXCLUDE)
install(FILES ${PROJECT_BINARY_DIR}/toolchain DESTINATION ${CMAKE_INSTALL_DATADIR}/cde/verilator)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR})  # manual pages and completions
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/prices.json docs/accuracy.json DESTINATION ${CMAKE_INSTALL_DATADIR}/cde/docs)
get_property(default_bitstreams GLOBAL PROPERTY CDE_DEFAULT_BITSTREAM_FILES)
install(CODE "
  set(files \"${default_bitstreams}\")
  foreach(file IN LISTS files)
    cmake_path(GET file PARENT_PATH folder)
    cmake_path(GET file FILENAME name)
    execute_process(COMMAND sha256sum --status -c \"\${name}.sha256\" WORKING_DIRECTORY \"\${folder}\" RESULT_VARIABLE not_whole ERROR_QUIET)
    if(not_whole)
      list(APPEND left_out \"\${name}\")
    else()
      file(INSTALL \"\${file}\" \"\${file}.sha256\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/cde/bitstreams\")
    endif()
  endforeach()
  if(left_out)
    list(LENGTH left_out count)
    message(STATUS \"Not installed, because not built: \${count} of the default bitstreams. The installed cde builds what it needs \"
      \"on first use, with Verilator and clang; to install them, run `cmake --build ${PROJECT_BINARY_DIR}` first\")
  endif()")
# What others can write is not loaded, whatever umask the clone and this were made with.
install(CODE "
  foreach(folder IN ITEMS ${CMAKE_INSTALL_DATADIR}/cde ${CMAKE_INSTALL_LIBDIR}/cde)
    if(EXISTS \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${folder}\")
      execute_process(COMMAND chmod -R go-w \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${folder}\")
    endif()
  endforeach()")

install(EXPORT cdeTargets NAMESPACE cde:: DESTINATION ${package_dir})
# cde::mpi is there for programs that find MPI.
if(CDE_MPI)
  install(TARGETS cde_mpi EXPORT cdeMpiTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT cdeMpiTargets NAMESPACE cde:: DESTINATION ${package_dir})
endif()
configure_package_config_file(cmake/cdeConfig.cmake.in ${PROJECT_BINARY_DIR}/cdeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cdeConfig.cmake ${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake DESTINATION ${package_dir})
