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

/// What happened on a card between two times: a transfer on its bus, an access of its local bus, a
/// descriptor of DMA, a pass, a primary, a secondary, a row of pair tests, a record. Times are
/// those of the rising edges of the clock at which registers saw it begin and end.
struct Transaction {
  std::string kind;   ///< "pci", "bus", "dma", "pass", "primary", "secondary", "test", "record"
  std::string label;  ///< one line, e.g. "host memory-write 0x00001000, 16 words"
  std::string scope;  ///< of the module that does it
  std::uint64_t begin = 0, end = 0;     ///< in units of the file
  std::optional<std::uint64_t> stalls;  ///< cycles that it waited
  std::string outcome;  ///< "done", "retry", "hit", ..., or "open" at the file's end
  std::vector<std::pair<std::string, std::string>> fields;  ///< what else is known, in its order
};

/// Kinds there are.
[[nodiscard]] const std::vector<std::string>& transaction_kinds();

/// Transactions of the kinds that are asked for (all, if none is) that lie in or reach into a
/// window, by their begin. Kinds whose signals the file does not have give none.
[[nodiscard]] std::vector<Transaction> transactions(Trace& trace,
                                                    const std::vector<std::string>& kinds,
                                                    std::uint64_t from, std::uint64_t to);
/// The same one by one, in the same order, without keeping them. False ends it.
void each_transaction(Trace& trace, const std::vector<std::string>& kinds, std::uint64_t from,
                      std::uint64_t to, const std::function<bool(const Transaction&)>& take);

}  // namespace cde::wave
