// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

namespace cde {

/// Processor and system of this machine, for files that hold wall times.
[[nodiscard]] nlohmann::ordered_json machine_json();

/// Most bytes that a command may use; larger requests are refused at the start. It is three
/// quarters of the machine's memory. A limit on the address space (ulimit -v) counts likewise, less
/// what a card's models reserve for DDR and SRAM.
[[nodiscard]] std::uint64_t memory_limit();

}  // namespace cde
