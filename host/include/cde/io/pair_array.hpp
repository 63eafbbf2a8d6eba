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

/// Pairs of a NumPy array, .npy or .npz, as rays are read from one (cde/io/rays.hpp): a last axis
/// with the words of A and of B, or structures with the fields A and B or with the names that a
/// header of a text has. Rays may lack tmin and tmax.
class PairArray {
 public:
  /// `bytes` are all of the file; `name` is the file's for messages. Error kFile for other arrays.
  PairArray(std::string bytes, const std::string& name, PairName named, const WordText& text);
  PairArray(PairArray&&) noexcept;
  PairArray& operator=(PairArray&&) noexcept;
  ~PairArray();

  /// Whether a file that begins with these bytes is an array.
  [[nodiscard]] static bool is_array(std::string_view bytes);

  [[nodiscard]] std::uint64_t size() const;
  /// Appends the words of a pair in slot order, each nearest to its number. It is malformed if a
  /// number is too large for the format; `where` begins `why`, which says so.
  [[nodiscard]] OperandLine read(std::uint64_t pair, const std::string& where,
                                 std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                                 std::string& why);
  /// The pair as a line, which OperandText reads as the same words.
  [[nodiscard]] std::string line(std::uint64_t pair);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace cde
