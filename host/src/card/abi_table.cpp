// SPDX-License-Identifier: Apache-2.0
#include "card/abi_table.hpp"

#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "cde/card/memory.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

void check_table(const SimulationModel& model, const cde_abi_head& head,
                 const cde_abi_head& built) {
  if (head.version == built.version && head.size == built.size) return;
  const std::string what =
      head.version != built.version
          ? fmt::format("C interface version {}; expected {}", head.version, built.version)
          : fmt::format("its table of functions has {} bytes; expected {}", head.size, built.size);
  throw Error(ErrorCode::kConfiguration,
              fmt::format("simulation model {}: {}; it was built from other sources",
                          printable_name(model.path().string()), what));
}

void no_memory_for_models() {
  throw Error(ErrorCode::kDevice,
              fmt::format("no memory for the card's models: they reserve {} MB of address space "
                          "for its DDR and SRAM, and use little of it (ulimit -v)",
                          kModelBytes >> 20));
}

void require_waves(std::string_view parameters) {
  if (parameters.find("TRACE=1") == std::string_view::npos) {
    throw Error(ErrorCode::kUsage,
                "this simulation model cannot write waves; open the board with BoardConfig::trace");
  }
}

void open_waves(const std::filesystem::path& file, const TraceOptions& which,
                std::optional<std::uint64_t> ddr_word, std::uint64_t clock,
                const std::function<int(const cde_trace*)>& open) {
  // A cycle on the time axis begins with the clock's low half. Its last time precedes the next
  // cycle.
  const auto time = [&](std::uint64_t cycles) {
    return cycles > std::numeric_limits<std::uint64_t>::max() / clock - 1
               ? std::numeric_limits<std::uint64_t>::max()
               : cycles * clock;
  };
  const std::uint64_t end = time(which.to);
  const std::string scopes = fmt::format("{}", fmt::join(which.scopes, "\n"));
  const cde_trace wanted = {
      .path = file.c_str(),
      .from = time(which.from),
      .to = end > std::numeric_limits<std::uint64_t>::max() - clock ? end : end + clock - 1,
      .ddr_word = ddr_word.value_or(CDE_TRACE_NOW),
      .length = time(which.cycles),
      .scopes = scopes.c_str()};
  const int answer = open(&wanted);
  if (answer == -1)
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot write waves", printable_name(file.string())));
  if (answer != 0)
    throw Error(ErrorCode::kUsage,
                fmt::format("waves of {}: the card has no signal or scope of that name",
                            in_quotes(which.scopes.at(static_cast<std::size_t>(-2 - answer)))));
}

void require_whole_waves(int error) {
  if (error == 0) return;
  throw Error(ErrorCode::kFile,
              fmt::format("the waves are incomplete: {}",
                          std::strerror(error)));  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace cde
