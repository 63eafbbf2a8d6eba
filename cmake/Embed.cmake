# SPDX-License-Identifier: Apache-2.0
# cde_embed(OUTPUT.cpp NAME=FILE ...)
#
# Writes a C++ source that defines `const PageAsset NAME` (tools/command/page/page.hpp) for every FILE. It holds the text of the file and
# its SHA-256, which the content security policy of a page names. Files are read at configure time.
function(cde_embed output)
  set(source "// Written by cmake/Embed.cmake.\n#include \"page/page.hpp\"\n\nnamespace cde::cli {\n")
  foreach(pair ${ARGN})
    string(REGEX REPLACE "=.*" "" name "${pair}")
    string(REGEX REPLACE "^[^=]*=" "" file "${pair}")
    file(READ ${file} text)
    string(SHA256 hash "${text}")
    if(text MATCHES "\r" OR text MATCHES "</(script|style)|<!--")
      message(FATAL_ERROR "${file}: contains a carriage return or the end of an HTML element; a page cannot hold these")
    endif()
    string(APPEND source "extern const PageAsset ${name} = {R\"cdepage(${text})cdepage\", \"${hash}\"};\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  string(APPEND source "}  // namespace cde::cli\n")
  file(WRITE ${output}.new "${source}")
  configure_file(${output}.new ${output} COPYONLY)  # touched only if it changed
endfunction()
