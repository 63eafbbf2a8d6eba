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

/// A field of a transaction as text, also "kind", "label", "scope", "begin", "end", "latency",
/// "stalls" and "outcome"; times are in units of the file. Nothing if it does not have the field.
[[nodiscard]] std::optional<std::string> field_of(const Transaction& t, std::string_view name);
/// Fields of all transactions, then those of these kinds (of all, if none is named), each once.
[[nodiscard]] std::vector<std::string> field_names(const std::vector<std::string>& kinds);
/// What a text says as a number: decimal, or hexadecimal with 0x.
[[nodiscard]] std::optional<double> as_number(std::string_view text);

/// A condition on transactions: `kind == pci && words > 4`, `outcome != done || !(stalls < 3)`,
/// `label ~ '*0x1000*'`. On the left is a field, on the right a value: a word, a number, a time
/// with a unit, or any text in quotes. = is ==, ~ compares with a pattern of * and ?. Numbers are
/// compared as such, whatever their form; < and the like are false if one side is none. A
/// comparison with a field that a transaction does not have is false, but != is true.
class Filter {
 public:
  /// Error kUsage, with a mark under the place. `kinds` are those whose fields may be named.
  Filter(const std::string& text, const std::vector<std::string>& kinds, Times& times);
  ~Filter();
  Filter(Filter&&) noexcept;

  [[nodiscard]] bool matches(const Transaction& t) const;

  struct Node;

 private:
  std::unique_ptr<Node> root_;
};

}  // namespace cde::wave
