// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/card/trace.hpp"
#include "cde/query/difference.hpp"
#include "cde/query/query.hpp"
#include "cde/support/error.hpp"

/// @file
/// A failure as data: all that `cde-explain` needs to pack it (cde/explain/bundle.hpp).
namespace cde {

/// A pair for which a unit and its reference differ.
struct PairFailure {
  PairConfig config = {};
  PairIterations iterations = {};
  std::string options = {};         ///< PAIR and options that run the same pipe again
  std::vector<std::uint64_t> a, b;  ///< words of all pairs of the run
  std::size_t at = 0;               ///< the pair that failed
  PairResult card = {}, reference = {};
};

/// A record for which a card and its reference differ.
struct CardFailure {
  PairConfig pipe = {};         ///< pipe of this pair, as a PairUnit
  std::string iterations = {};  ///< iterations as `cde query` takes them; may be empty
  bool swap = false;            ///< the secondary is the pair's first shape
  Mode mode = Mode::kNearest;
  Difference difference = {};
  std::uint32_t place = 0;   ///< slot of the primary in its packet
  std::uint64_t cycles = 0;  ///< lower bound of the cycles of the pass
};

/// A card or unit that stopped, or reported an error.
struct HangFailure {
  std::uint64_t cycle = 0;  ///< last cycle with progress, counted as `rerun` counts
  bool unit = false;        ///< a unit, not a card: `cycle` is exact, and there are no transactions
  std::vector<std::string> shown = {};  ///< signals to look at first
};

struct Failure {
  std::variant<PairFailure, CardFailure, HangFailure> kind = {};
  std::string message = {}, repeat = {};  ///< the verb's text; the command that repeats it.
  std::string details = "{}";             ///< Further keys of fail.json, as a JSON object.
  std::vector<std::pair<std::string, std::string>> files = {};  ///< Further files: name and text.
  /// Repeats the failure on a card and writes waves to `file`. Returns whether the answer is the
  /// same. Not needed for pairs.
  std::function<bool(const std::string& file, const TraceOptions& which)> rerun = {};
};

/// Whether an error is a hang: code kTimeout or kDevice.
[[nodiscard]] bool is_hang(const Error& error);

/// Everything but `rerun`. Words are hexadecimal texts, so every bit stays.
[[nodiscard]] nlohmann::ordered_json to_json(const Failure& failure);
/// The inverse of to_json. Error kBadInput if a key is missing or has another type.
[[nodiscard]] Failure failure_from_json(const nlohmann::ordered_json& json);
[[nodiscard]] nlohmann::ordered_json to_json(const TraceOptions& which);
[[nodiscard]] TraceOptions trace_options_from_json(const nlohmann::ordered_json& json);

}  // namespace cde
