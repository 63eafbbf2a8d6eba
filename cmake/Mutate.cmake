# SPDX-License-Identifier: Apache-2.0
# Included by the copy of tools/mutate: a test executable is built without the bitstreams that any of its tests may open; those of the
# tests that run are built when they are opened.
function(add_dependencies target)
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL EXECUTABLE)
    _add_dependencies(${target} ${ARGN})
  endif()
endfunction()
