// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

#include "cde/abi/abi_head.h"
#include "cde/bitstream/bitstream.hpp"
#include "cde/card/board.hpp"
#include "cde/card/trace.hpp"

namespace cde {

/// Error kConfiguration unless a bitstream's table of functions is the one that this driver was
/// built with: version and size.
void check_table(const Bitstream& bitstream, const cde_abi_head& head, const cde_abi_head& built);

/// The table of functions of a bitstream, `Entry` being the type of the only function that it
/// exports. Error kConfiguration if it exports no such function, or another table.
template <class Entry>
[[nodiscard]] auto abi_table(const Bitstream& bitstream, const char* entry, std::uint32_t version) {
  const auto* const table = reinterpret_cast<Entry>(bitstream.symbol(entry))();
  check_table(bitstream, table->head, {version, static_cast<std::uint32_t>(sizeof *table)});
  return table;
}

/// Errors of a card's models, the same whichever bus they are behind.
[[noreturn]] void no_memory_for_models();
/// Error kUsage if the bitstream has no waves, by its parameters.
void require_waves(std::string_view parameters);
/// Asks a model for waves; `clock` is the length of one on the time axis, `open` its trace_open.
/// Error kFile if the file cannot be written, kUsage if there is no such signal.
void open_waves(const std::filesystem::path& file, const TraceOptions& which,
                std::optional<std::uint64_t> ddr_word, std::uint64_t clock,
                const std::function<int(const cde_trace*)>& open);
/// What a bitstream's trace_close answers: 0, or the errno of what could not be written.
void require_whole_waves(int error);

}  // namespace cde
