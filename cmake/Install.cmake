# SPDX-License-Identifier: Apache-2.0
# `cmake --install` has these components:
#
#   `cde`      The program cde, the RTL, the builder of simulation models, the built default models, and the documents.
#   `cde-wave`, `cde-explain`, `cde-accuracy`, `cde-bench`    The other programs.
#   `library`  Libraries, headers, and the package for find_package(cde [COMPONENTS wave oracle ...]).
#
# It works from any state of the build, because the targets of a component are built first. Simulation models take minutes and are not
# built. An installed cde builds them on first use if it finds Verilator and clang.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cde)
get_property(libraries GLOBAL PROPERTY CDE_LIBRARIES)
get_property(programs GLOBAL PROPERTY CDE_PROGRAMS)

# Builds the missing targets of a component before it is installed.
function(cde_build_before component)
  add_custom_target(cde_installed_${component})
  add_dependencies(cde_installed_${component} ${ARGN})
  set(files "")
  foreach(target IN LISTS ARGN)
    list(APPEND files "$<TARGET_FILE:${target}>")
  endforeach()
  install(CODE "
    foreach(file IN ITEMS ${files})
      if(NOT EXISTS \"\${file}\")
        message(STATUS \"Not built yet: building ${component}\")
        execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${CMAKE_BINARY_DIR}\" --target cde_installed_${component}
          COMMAND_ERROR_IS_FATAL ANY)
        break()
      endif()
    endforeach()" COMPONENT ${component})
endfunction()

# ---- Libraries, with one export each, so that a package may lack some ----
list(TRANSFORM libraries PREPEND cde_ OUTPUT_VARIABLE library_targets)
cde_build_before(library ${library_targets})
foreach(library IN LISTS libraries)
  install(TARGETS cde_${library} EXPORT cde-${library} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(EXPORT cde-${library} NAMESPACE cde:: DESTINATION ${package_dir} COMPONENT library)
endforeach()
install(TARGETS cde EXPORT cde-cde)
install(EXPORT cde-cde NAMESPACE cde:: DESTINATION ${package_dir} COMPONENT library)
install(DIRECTORY host/include/cde DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
if(CDE_MPI)
  set(cde_jobs_needs mpi)
endif()
configure_package_config_file(cmake/cdeConfig.cmake.in ${PROJECT_BINARY_DIR}/cdeConfig.cmake INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cdeConfig.cmake ${PROJECT_BINARY_DIR}/cdeConfigVersion.cmake DESTINATION ${package_dir} COMPONENT library)

# ---- Programs, each with the manual pages of its verbs ----
foreach(program IN LISTS programs)
  get_target_property(name ${program} OUTPUT_NAME)
  get_target_property(pages ${program} CDE_MANUAL_PAGES)
  cde_build_before(${name} ${program})
  install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${name})
  foreach(page IN LISTS pages)
    install(FILES ${CDE_SHARE_DIR}/man/man1/${page}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${name} OPTIONAL)
  endforeach()
endforeach()
foreach(shell bash-completion zsh fish)
  install(DIRECTORY ${CDE_SHARE_DIR}/${shell} DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT cde)
endforeach()

# ---- Sources of simulation models ----
set(share ${CMAKE_INSTALL_DATADIR}/cde)
install(DIRECTORY rtl DESTINATION ${share} COMPONENT cde FILES_MATCHING PATTERN *.sv PATTERN *.svh PATTERN *.f)
install(DIRECTORY host/include/cde/contract host/include/cde/abi DESTINATION ${share}/host/include/cde COMPONENT cde)
install(DIRECTORY verilator DESTINATION ${share} USE_SOURCE_PERMISSIONS COMPONENT cde PATTERN CMakeLists.txt EXCLUDE)
install(FILES ${PROJECT_BINARY_DIR}/toolchain DESTINATION ${share}/verilator COMPONENT cde)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT cde)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT cde
  FILES_MATCHING PATTERN *.md PATTERN *.json PATTERN *.svg PATTERN *.png PATTERN maintainer EXCLUDE)
install(FILES docs/costs.json docs/accuracy.json DESTINATION ${share}/docs COMPONENT cde)
get_property(default_models GLOBAL PROPERTY CDE_DEFAULT_MODEL_FILES)
install(CODE "
  set(files \"${default_models}\")
  foreach(file IN LISTS files)
    cmake_path(GET file PARENT_PATH folder)
    cmake_path(GET file FILENAME name)
    execute_process(COMMAND sha256sum --status -c \"\${name}.sha256\" WORKING_DIRECTORY \"\${folder}\" RESULT_VARIABLE not_whole ERROR_QUIET)
    if(not_whole)
      list(APPEND left_out \"\${name}\")
    else()
      file(INSTALL \"\${file}\" \"\${file}.sha256\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/cde/models\")
    endif()
  endforeach()
  if(left_out)
    list(LENGTH left_out count)
    message(STATUS \"Not installed, because not built: \${count} of the default models. The installed cde builds what it needs \"
      \"on first use, with Verilator and clang; to install them, run `cmake --build ${PROJECT_BINARY_DIR}` first\")
  endif()" COMPONENT cde)
# cde does not load files that others can write. This removes such permissions, for any umask of the clone and the build.
install(CODE "
  foreach(folder IN ITEMS ${share} ${CMAKE_INSTALL_LIBDIR}/cde)
    if(EXISTS \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${folder}\")
      execute_process(COMMAND chmod -R go-w \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${folder}\")
    endif()
  endforeach()" COMPONENT cde)
