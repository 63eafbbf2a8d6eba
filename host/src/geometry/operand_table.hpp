// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "support/table_form.hpp"

namespace cde {

/// Columns of a pair's operands, A before B: "A.center.x" and so on. The interval of a ray is
/// optional.
[[nodiscard]] text::TableForm operand_table(PairName named);

/// Appends words, given in the order of the table's columns, to A and B in slot order.
void append_operands(PairName named, const std::vector<std::uint64_t>& words,
                     std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b);

}  // namespace cde
