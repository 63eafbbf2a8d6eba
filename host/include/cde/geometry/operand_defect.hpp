// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"

namespace cde {

/// Why the card refuses a pair: operand, field, value and rule, in the arithmetic of the format
/// ("sphere B: radius is -1, must be > 0"). Empty if it accepts the pair. Operand words are in slot
/// order. Error kUsage for a format not in kPairFormats.
[[nodiscard]] std::string operand_defect(Pair pair, FpFormat format,
                                         std::span<const std::uint64_t> a,
                                         std::span<const std::uint64_t> b);

}  // namespace cde
