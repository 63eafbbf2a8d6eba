// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "support/table_form.hpp"

namespace cde {

/// Columns of pairs in the order of their name, A before B: "A.center.x" and so on. The interval of
/// a ray is optional.
[[nodiscard]] text::TableForm operand_table(PairName named);

/// Appends words in the order of the table's names to those of A and of B in slot order.
void append_operands(PairName named, const std::vector<std::uint64_t>& words,
                     std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b);

}  // namespace cde
