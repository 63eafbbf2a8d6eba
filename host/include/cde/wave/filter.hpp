// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/time.hpp"
#include "cde/wave/transaction.hpp"

namespace cde::wave {

/// A field of a transaction as text. Also "kind", "label", "scope", "begin", "end", "latency",
/// "stalls" and "outcome"; times are in units of the file. Nothing if it lacks the field.
[[nodiscard]] std::optional<std::string> field_of(const Transaction& t, std::string_view name);
/// Common fields, then the fields of these kinds (all kinds if none is named), without duplicates.
[[nodiscard]] std::vector<std::string> field_names(const std::vector<std::string>& kinds);
/// The number that a text means: decimal, or hexadecimal with 0x.
[[nodiscard]] std::optional<double> as_number(std::string_view text);

/// A condition on transactions: `kind == pci && words > 4`, `outcome != done || !(stalls < 3)`,
/// `label ~ '*0x1000*'`. A field is on the left, a value on the right: a word, a number, a time
/// with a unit, or any quoted text.
///
/// = means ==; ~ matches a pattern of * and ?. Numbers are compared by value, whatever their form.
/// Order comparisons are false if a side is not a number. A comparison with a missing field is
/// false, except !=, which is true.
class Filter {
 public:
  /// Error kUsage, with a mark under the position. `kinds` are those whose fields may be named.
  Filter(const std::string& text, const std::vector<std::string>& kinds, Times& times);
  ~Filter();
  Filter(Filter&&) noexcept;

  [[nodiscard]] bool matches(const Transaction& t) const;

  struct Node;

 private:
  std::unique_ptr<Node> root_;
};

}  // namespace cde::wave
