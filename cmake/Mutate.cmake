# SPDX-License-Identifier: Apache-2.0
# Included by the copy of tools/mutate. It builds a test executable without the simulation models of its tests. Tests that run build
# their models when they open them.
function(add_dependencies target)
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL EXECUTABLE)
    _add_dependencies(${target} ${ARGN})
  endif()
endfunction()
