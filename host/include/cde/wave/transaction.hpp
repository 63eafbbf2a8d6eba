// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// An activity on a card between two times. It is a bus transfer, local bus access, DMA descriptor,
/// pass, primary, secondary, row of pair tests, or record. Times are the rising clock edges at
/// which registers see its begin and end.
struct Transaction {
  std::string kind;   ///< "pci", "bus", "dma", "pass", "primary", "secondary", "test", "record"
  std::string label;  ///< one line, e.g. "host memory-write 0x00001000, 16 words"
  std::string scope;  ///< scope of the module that does it
  std::uint64_t begin = 0, end = 0;     ///< in units of the file
  std::optional<std::uint64_t> stalls;  ///< cycles in which it waited
  std::string outcome;  ///< "done", "retry", "hit", ..., or "open" at the file's end
  std::vector<std::pair<std::string, std::string>> fields;  ///< further fields, in their order
};

/// All kinds.
[[nodiscard]] const std::vector<std::string>& transaction_kinds();

/// Transactions of these kinds (all if none is given) that overlap a window, ordered by begin.
/// Kinds whose signals are not in the file give none.
[[nodiscard]] std::vector<Transaction> transactions(Trace& trace,
                                                    const std::vector<std::string>& kinds,
                                                    std::uint64_t from, std::uint64_t to);
/// The same one by one, in the same order, without storing them. `take` returns false to stop.
void each_transaction(Trace& trace, const std::vector<std::string>& kinds, std::uint64_t from,
                      std::uint64_t to, const std::function<bool(const Transaction&)>& take);

}  // namespace cde::wave
