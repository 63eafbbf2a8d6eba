// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

#include "cde/abi/abi_head.h"
#include "cde/card/board.hpp"
#include "cde/card/trace.hpp"
#include "cde/model/model.hpp"

namespace cde {

/// Checks the version and size of a simulation model's function table against the driver's. Error
/// kConfiguration if they differ.
void check_table(const SimulationModel& model, const cde_abi_head& head, const cde_abi_head& built);

/// The function table of a simulation model. `Entry` is the type of the only function that the
/// model exports. Error kConfiguration if it exports no such function or another table.
template <class Entry>
[[nodiscard]] auto abi_table(const SimulationModel& model, const char* entry,
                             std::uint32_t version) {
  const auto* const table = reinterpret_cast<Entry>(model.symbol(entry))();
  check_table(model, table->head, {version, static_cast<std::uint32_t>(sizeof *table)});
  return table;
}

/// Errors of a card's models, on either bus.
[[noreturn]] void no_memory_for_models();
/// Error kUsage if the simulation model cannot write waves, according to its parameters.
void require_waves(std::string_view parameters);
/// Asks a model for waves. `clock` is the length of a cycle on the time axis, and `open` is the
/// model's trace_open. Error kFile if the file cannot be written, kUsage if there is no such
/// signal.
void open_waves(const std::filesystem::path& file, const TraceOptions& which,
                std::optional<std::uint64_t> ddr_word, std::uint64_t clock,
                const std::function<int(const cde_trace*)>& open);
/// Checks the result of a model's trace_close: 0, or the errno of a failed write.
void require_whole_waves(int error);

}  // namespace cde
