// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/card/trace.hpp"
#include "cde/query/difference.hpp"
#include "cde/support/error.hpp"
#include "command/cli_fwd.hpp"
#include "explain/explanation.hpp"
#include "wave/origin.hpp"

/// What a failure leaves: one folder with the waves around it, where card and reference part, and
/// the commands that repeat it.
namespace cde::cli {

/// --bundle and --no-bundle of a verb.
struct BundleRequest {
  std::string folder = "cde-failure";
  bool wanted = true;
};
void add_bundle_options(CLI::App& verb, BundleRequest& request);

class Bundle {
 public:
  /// Makes the folder, or the first of FOLDER-2, FOLDER-3, ... that is not there. Error kFile.
  explicit Bundle(const std::string& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// What is to stand in fail.json.
  [[nodiscard]] nlohmann::ordered_json& json() { return json_; }
  /// A part of fail.txt.
  void add(std::string_view heading, std::string_view text);
  void write(const std::string& name, std::string_view text);
  /// fail.json and fail.txt.
  void finish();

 private:
  std::filesystem::path folder_;
  nlohmann::ordered_json json_;
  std::vector<std::string> sections_;  ///< of fail.txt
};

/// Runs `fill`, and says in a line to be put behind the error where the failure is packed, or why
/// it is not. Nothing if it is not wanted.
[[nodiscard]] std::string packed(const BundleRequest& request, bool quiet,
                                 const std::function<void(Bundle&)>& fill);

/// Waves `whole`, which it removes, become waves.fst and waves.gtkw in the bundle: what lies
/// between `before` clocks ahead of `fail` and `behind` clocks after it. `shown` are the words, as
/// `cde wave show` takes them, of what GTKWave shows first; those that are not there are left out.
/// `json["wave_window"]` says what they are of.
struct WaveWindow {
  std::uint64_t fail = 0;  ///< in units of the file
  std::uint64_t before = 40, behind = 10;
  std::vector<std::string> shown = {};
  std::vector<std::string> first = {};    ///< of them, for a command to look at the waves
  std::string what = "the wrong answer";  ///< that is at `fail`
};
void keep_waves(Bundle& bundle, const std::filesystem::path& whole, const WaveWindow& window);

/// A pair that a unit answered otherwise than its reference.
struct PairFailure {
  PairConfig config;
  PairBudget budget;
  std::string options;                  ///< PAIR and options for another run of the same pipe
  std::span<const std::uint64_t> a, b;  ///< of the pair and of those that went with it
  std::size_t at = 0;                   ///< which of them it is
  PairResult card, reference;
  std::string message, repeat;  ///< as the verb tells it, and its own command
};
void bundle_pair(Bundle& bundle, const PairFailure& failure);

/// A record that a card and its reference differ in.
struct CardFailure {
  PairConfig pipe;     ///< that tested the primary, as a unit of its own
  std::string budget;  ///< as `cde query` takes it; may be empty
  bool swap = false;   ///< the secondary is the pair's first shape
  Mode mode = Mode::kNearest;
  Difference difference;
  std::uint32_t place = 0;      ///< of the primary in its packet
  std::uint64_t clocks = 0;     ///< that the pass takes at the least
  std::string message, repeat;  ///< as the verb tells it, and its own command
  /// Does it again on a card with waves, which go to a file; whether the record is the same.
  std::function<bool(const std::string& file, const TraceOptions& which)> rerun;
};
void bundle_card(Bundle& bundle, const CardFailure& failure);

/// A card that did not end what it was asked, or said that it cannot.
struct HangFailure {
  std::string message, repeat;
  std::uint64_t clock = 0;  ///< since which it was not seen to go on, counted as `rerun` counts
  bool unit = false;        ///< `clock` is exact, and there are no transactions: a unit, not a card
  std::vector<std::string> shown = {};  ///< what is looked at first
  /// Does it again on a card with waves, which go to a file.
  std::function<void(const std::string& file, const TraceOptions& which)> rerun = {};
};
void bundle_hang(Bundle& bundle, const HangFailure& failure);
/// Whether an error is one.
[[nodiscard]] bool is_hang(const Error& error);

/// The explanation of a pair: explain.txt, `json["first_differences"]` and a part of fail.txt.
/// False if the pipe by itself answers as the reference.
bool bundle_explanation(Bundle& bundle, const explain::Explanation& explanation,
                        const std::string& options, const std::string& words);

/// Where the word that `signal` has at a time of the waves in `file` was made; where it is, if that
/// is not known.
[[nodiscard]] wave::Origin made_at(const std::filesystem::path& file, const std::string& signal,
                                   std::uint64_t time);

/// What made `signal` have its value at the failure, with its lines: why.txt. `made` says where
/// it was made, in waves.fst. `signal` as `cde wave why` takes it.
void bundle_causes(Bundle& bundle, const std::string& signal, const wave::Origin& made);

/// Words as hexfloats.
[[nodiscard]] nlohmann::ordered_json result_json(const FpFormat& format, const PairResult& result);
[[nodiscard]] nlohmann::ordered_json record_json(const std::optional<Record>& record);

}  // namespace cde::cli
