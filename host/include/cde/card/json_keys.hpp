// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "cde/card/board.hpp"

/// What several verbs say in JSON, under the same keys in all of them.
namespace cde {

/// "version" and "commit" of this command, before the others.
[[nodiscard]] nlohmann::ordered_json program_json();

/// "lanes", "arithmetic", "format", "algorithm", "box", and "parameters": what the card is.
[[nodiscard]] nlohmann::ordered_json card_json(const BoardConfig& config);

/// "bitstream", "config_hash": which one was loaded.
[[nodiscard]] nlohmann::ordered_json bitstream_json(const std::filesystem::path& file,
                                                    std::uint64_t config_hash);

/// What the card counted: "tests", "rows", "device_cycles" of the passes, "stall_cycles" and
/// "bubble_cycles" in them, "writeback_cycles" behind them, "open_pairs", "secondaries",
/// "bad_primaries", "bad_secondaries", "corrected_words".
[[nodiscard]] nlohmann::ordered_json counters_json(const Counters& counters);

/// Modelled seconds, parts of a whole: "upload", "compute", "write_back", "download", "registers",
/// "total"; `before` is time of uploads that `time` has not.
[[nodiscard]] nlohmann::ordered_json time_json(const ModelledTime& time, std::uint64_t before = 0);

}  // namespace cde
