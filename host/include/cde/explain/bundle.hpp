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
#include "cde/check/failure.hpp"
#include "cde/explain/explanation.hpp"
#include "cde/support/error.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/origin.hpp"

/// What a failure leaves: one folder with the waves around it, where card and reference part, and
/// the commands that repeat it.
namespace cde {

class Bundle {
 public:
  /// Makes the folder, or the first of FOLDER-2, FOLDER-3, ... that is not there. Error kFile.
  explicit Bundle(const std::string& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// A file of the folder that was made, whatever lies under the folder's name by now. Other
  /// processes of this user can open it, too, while this object is there.
  [[nodiscard]] std::filesystem::path file(std::string_view name) const;
  /// What is to stand in fail.json.
  [[nodiscard]] nlohmann::ordered_json& json() { return json_; }
  /// A part of fail.txt.
  void add(std::string_view heading, std::string_view text);
  void write(const std::string& name, std::string_view text);
  /// fail.json and fail.txt.
  void finish();

 private:
  std::optional<OutputFolder> made_;
  std::filesystem::path folder_;  ///< as it is named
  nlohmann::ordered_json json_;
  std::vector<std::string> sections_;  ///< of fail.txt
};

/// Makes the folder, packs the failure into it, and returns its path. What cannot be packed is
/// named in fail.json and in `missing`. Error kFile if no folder can be made.
struct Packed {
  std::filesystem::path folder;
  std::string missing;
};
[[nodiscard]] Packed pack(const std::string& folder, const Failure& failure);

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

void bundle_pair(Bundle& bundle, const Failure& failure);
void bundle_card(Bundle& bundle, const Failure& failure);
void bundle_hang(Bundle& bundle, const Failure& failure);

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

}  // namespace cde
