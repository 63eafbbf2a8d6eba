// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/number_text.hpp"
#include "cde/geometry/operand_line.hpp"

namespace cde {

/// Pairs from a NumPy array (.npy or .npz), by the rules of cde/io/rays.hpp. Either the last axis
/// holds the words of A and of B. Or the array is structured, with fields A and B, or with the
/// names that a text header uses. Rays may lack tmin and tmax.
class PairArray {
 public:
  /// `bytes` is the whole file; `name` names it in messages. Error kFile for any other array.
  PairArray(std::string bytes, const std::string& name, PairName named, const WordText& text);
  PairArray(PairArray&&) noexcept;
  PairArray& operator=(PairArray&&) noexcept;
  ~PairArray();

  /// Whether a file that begins with these bytes is a NumPy array.
  [[nodiscard]] static bool is_array(std::string_view bytes);

  [[nodiscard]] std::uint64_t size() const;
  /// Appends the words of a pair in slot order, each rounded to nearest. A pair is malformed if a
  /// number is too large for the format. Then `why` says so, and begins with `where`.
  [[nodiscard]] OperandLine read(std::uint64_t pair, const std::string& where,
                                 std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                                 std::string& why);
  /// The pair as a text line that OperandText reads back as the same words.
  [[nodiscard]] std::string line(std::uint64_t pair);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace cde
