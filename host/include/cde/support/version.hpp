// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// What this command was built from: "0.1.0", and the commit with "+" behind it if files differed
/// from it; empty where the sources are in no Git clone. Written by cmake/Version.cmake.
extern const char* const kVersion;
extern const char* const kCommit;
/// "GNU 12.2.0", the compiler of driver and command.
extern const char* const kCompiler;
/// First lines of what Verilator and clang said of themselves when the build was configured.
extern const char* const kVerilator;
extern const char* const kClang;

/// All of it, a line each, as `cde --version` prints it.
[[nodiscard]] std::string version_text();

}  // namespace cde
