// SPDX-License-Identifier: Apache-2.0
#include "cde/card/json_keys.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "cde/support/version.hpp"

namespace cde {

using Json = nlohmann::ordered_json;

Json program_json() {
  return {{"version", kVersion}, {"commit", kCommit}};
}

Json card_json(const BoardConfig& config) {
  return {{"lanes", config.lanes},
          {"arithmetic", config.arithmetic == Arithmetic::kRtl ? "rtl" : "host"},
          {"format", config.format.name()},
          {"algorithm", name(config.algorithm)},
          {"box", config.box},
          {"parameters", config.parameters()}};
}

Json model_json(const std::filesystem::path& file, std::uint64_t config_hash) {
  return {{"model", file.string()}, {"config_hash", fmt::format("{:016x}", config_hash)}};
}

Json counters_json(const Counters& c) {
  return {{"tests", c.pairs},
          {"rows", c.rows},
          {"device_cycles", c.cycles},
          {"stall_cycles", c.stalls},
          {"bubble_cycles", c.bubbles},
          {"writeback_cycles", c.writeback},
          {"uncertain_pairs", c.uncertain},
          {"secondaries", c.secondaries},
          {"bad_primaries", c.bad_primaries},
          {"bad_secondaries", c.bad_secondaries},
          {"corrected_words", c.corrected_words},
          {"nodes", c.nodes},
          {"cached_nodes", c.cached_nodes},
          {"fetched_nodes", c.fetched_nodes},
          {"leaves", c.leaves},
          {"deepest", c.deepest}};
}

Json time_json(const ModelledTime& t, std::uint64_t before) {
  const auto seconds = [](std::uint64_t ps) { return static_cast<double>(ps) * 1e-12; };
  return {{"upload", seconds(before + t.load)},  {"compute", seconds(t.engine)},
          {"write_back", seconds(t.write_back)}, {"download", seconds(t.download)},
          {"registers", seconds(t.registers)},   {"total", seconds(before + t.total())}};
}

}  // namespace cde
