// SPDX-License-Identifier: Apache-2.0
#include "cde/support/version.hpp"

#include <fmt/format.h>

namespace cde {

std::string version_text() {
  const std::string commit = kCommit;
  return fmt::format("cde {}{}\ncompiler         {}\nmodels           {}\n                 {}",
                     kVersion, commit.empty() ? "" : fmt::format(" (commit {})", commit), kCompiler,
                     kVerilator, kClang);
}

}  // namespace cde
