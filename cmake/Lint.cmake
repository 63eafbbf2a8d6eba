# SPDX-License-Identifier: Apache-2.0
# Static checks as targets, and the fast ones as tests. tools/lint does the work. Faults planted in a copy of the sources by
# tools/mutate: that its table fits the sources is a test, the faults themselves are one of tools/test --full.
set(lint ${CMAKE_COMMAND} -E env CDE_BUILD=${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/tools/lint)
add_custom_target(lint COMMAND ${lint} rtl lines slang yosys icarus rooms format scripts streams USES_TERMINAL VERBATIM)
add_custom_target(tidy COMMAND ${lint} tidy USES_TERMINAL VERBATIM)
if(CDE_TESTS)
  foreach(check rtl lines slang rooms format scripts streams)
    add_test(NAME lint.${check} COMMAND ${lint} ${check})
    set_tests_properties(lint.${check} PROPERTIES LABELS lint SKIP_RETURN_CODE 77)
  endforeach()
  set(mutate ${CMAKE_COMMAND} -E env CDE_BUILD=${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/tools/mutate)
  add_test(NAME mutate.table COMMAND ${mutate} --list)
  add_test(NAME mutate.faults COMMAND ${mutate} --full)
  set_tests_properties(mutate.table mutate.faults PROPERTIES LABELS mutate SKIP_RETURN_CODE 77 RUN_SERIAL ON TIMEOUT 7200)
endif()
