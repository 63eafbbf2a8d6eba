// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// The sources of this command: the version "0.1.0", and the commit, with "+" if files differed
/// from it. The commit is empty if the sources are not in a Git clone. Written by
/// cmake/Version.cmake.
extern const char* const kVersion;
extern const char* const kCommit;
/// "GNU 12.2.0", the compiler of driver and command.
extern const char* const kCompiler;
/// First line of the version output of Verilator and clang when the build was configured.
extern const char* const kVerilator;
extern const char* const kClang;

/// All of it, one item per line, as `cde --version` prints it.
[[nodiscard]] std::string version_text();

}  // namespace cde
