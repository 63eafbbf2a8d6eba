// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "options/pair_options.hpp"

namespace cde::cli {

/// A pair and its pipe.
struct NamedPair {
  PairOptions options;
  std::string words;  ///< as `cde query` reads them
};

/// The pair in a line that a failing test or verb has printed: what stands around its command does
/// not matter. Error kUsage, with what is expected.
[[nodiscard]] NamedPair pair_in_line(const std::string& line);

}  // namespace cde::cli
