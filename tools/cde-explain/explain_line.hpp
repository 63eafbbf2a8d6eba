// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "options/pair_options.hpp"

namespace cde::cli {

/// A pair and the options of its pipe.
struct NamedPair {
  PairOptions options;
  std::string words;  ///< operands, as `cde query` reads them
};

/// The pair in a line that a failing test or verb printed. Text around the command does not matter.
/// Error kUsage, with the expected form.
[[nodiscard]] NamedPair pair_in_line(const std::string& line);

}  // namespace cde::cli
