// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/number_text.hpp"
#include "cde/geometry/pair.hpp"

/// A line of text with the words of a pair.
namespace cde {

enum class OperandLine { kNothing, kMalformed, kPair };

/// Appends the words of A and of B, in slot order, if the line has them, those of B first where the
/// pair is named so: separated by commas or
/// blanks, with a | between A and B or without. A ray without an interval gets all of it. Nothing
/// is an empty line and a comment (#). `where` names the line in `why`, which says what is wrong
/// with a malformed one.
[[nodiscard]] OperandLine read_operands(PairName named, const WordText& text,
                                        const std::string& where, std::string_view line,
                                        std::vector<std::uint64_t>& a,
                                        std::vector<std::uint64_t>& b, std::string& why);

/// Whether A is a ray.
[[nodiscard]] bool has_ray(Pair pair);

}  // namespace cde
