// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

namespace cde {

/// The processor and system that this runs on, for files that hold wall times.
[[nodiscard]] nlohmann::ordered_json machine_json();

/// Bytes that a command takes at most: three quarters of the machine's memory, and of what a limit
/// on the address space (ulimit -v) leaves beside a card's models, which reserve their DDR and
/// SRAM. What needs more is refused before it is begun.
[[nodiscard]] std::uint64_t memory_limit();

}  // namespace cde
