// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cde/query/record.hpp"

namespace cde {

/// A record in which a card and its reference differ, with its operands.
struct Difference {
  std::optional<Record> card, reference;  ///< none: that side has no such record
  std::vector<float> primary;  ///< words of the primary in slot order, as sent; empty if the record
                               ///< names no valid primary.
  /// Secondaries that either record names, by index, with the words that reach the pipes.
  std::vector<std::pair<std::uint32_t, std::vector<float>>> secondaries;

  /// Number of the primary, counted as in the records.
  [[nodiscard]] std::uint32_t number() const { return (card ? card : reference)->primary; }
};

}  // namespace cde
