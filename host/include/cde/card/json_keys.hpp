// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "cde/card/board.hpp"

/// @file
/// JSON output that several verbs share, under the same keys.
namespace cde {

/// "version" and "commit" of this command, as the first keys.
[[nodiscard]] nlohmann::ordered_json program_json();

/// Configuration of the card: "lanes", "arithmetic", "format", "algorithm", "box", "parameters".
[[nodiscard]] nlohmann::ordered_json card_json(const BoardConfig& config);

/// The loaded simulation model: "model", "config_hash".
[[nodiscard]] nlohmann::ordered_json model_json(const std::filesystem::path& file,
                                                std::uint64_t config_hash);

/// Counters of the card: "tests", "rows", "device_cycles" of the passes, "stall_cycles" and
/// "bubble_cycles" in them, "writeback_cycles" after them. Also "uncertain_pairs", "secondaries",
/// "bad_primaries", "bad_secondaries", "corrected_words".
[[nodiscard]] nlohmann::ordered_json counters_json(const Counters& counters);

/// Modelled seconds: "upload", "compute", "write_back", "download", "registers", and their sum
/// "total". `before` is upload time that `time` does not include.
[[nodiscard]] nlohmann::ordered_json time_json(const ModelledTime& time, std::uint64_t before = 0);

}  // namespace cde
