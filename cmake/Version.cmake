# SPDX-License-Identifier: Apache-2.0
# Writes version.cpp (host/include/cde/support/version.hpp) in every build. An unchanged file keeps its time.
#
#   cmake -DOUTPUT=version.cpp -DSOURCE=ROOT -DVERSION=1.2.3 -DCOMPILER="GNU 12" -DTOOLCHAIN=FILE -P Version.cmake
set(commit "")
find_program(git git)
if(git AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit RESULT_VARIABLE failed
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(failed)
    set(commit "")
  else()
    execute_process(COMMAND ${git} -C ${SOURCE} --no-optional-locks status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      string(APPEND commit "+")
    endif()
  endif()
endif()
file(STRINGS ${TOOLCHAIN} lines)
list(FILTER lines INCLUDE REGEX "Verilator|clang")
list(GET lines 0 verilator)
list(GET lines 1 clang)
set(text "// Written by cmake/Version.cmake.\n#include \"cde/support/version.hpp\"\n\nnamespace cde {\n")
foreach(pair kVersion=${VERSION} kCommit=${commit} kCompiler=${COMPILER} kVerilator=${verilator} kClang=${clang})
  string(REGEX REPLACE "=.*" "" name "${pair}")
  string(REGEX REPLACE "^[^=]*=" "" value "${pair}")
  string(APPEND text "extern const char* const ${name} = R\"(${value})\";\n")
endforeach()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}}  // namespace cde\n" @ONLY)
