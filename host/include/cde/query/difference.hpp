// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cde/query/record.hpp"

namespace cde {

/// A record that a card and its reference differ in, and what it was made of.
struct Difference {
  std::optional<Record> card, reference;  ///< none: that side has no such record
  std::vector<float> primary;  ///< words of the primary in slot order, as it was sent; empty if the
                               ///< record names none that there is
  /// Secondaries that either record names, as they stand before the pipes, by their index.
  std::vector<std::pair<std::uint32_t, std::vector<float>>> secondaries;

  /// Its number, counted as in the records.
  [[nodiscard]] std::uint32_t number() const { return (card ? card : reference)->primary; }
};

}  // namespace cde
