// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
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
#include "cde/support/scratch.hpp"
#include "cde/wave/origin.hpp"

/// @file
/// A failure bundle: one folder with the waves around the failure, the first difference between
/// card and reference, and the commands that repeat it.
namespace cde {

class Bundle {
 public:
  /// Creates the folder, or the first of FOLDER-2, FOLDER-3, ... that does not exist. Error kFile.
  /// Error kUsage if the path cannot name a new folder, as "." cannot. Without finish(), the
  /// destructor or a signal removes the folder.
  explicit Bundle(const std::string& folder);
  ~Bundle();
  Bundle(const Bundle&) = delete;
  Bundle& operator=(const Bundle&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Path of a file in the created folder, even if the folder's name leads elsewhere by now. Other
  /// processes of this user can also open it while this object lives.
  [[nodiscard]] std::filesystem::path file(std::string_view name) const;
  /// The same for a file that is to be written.
  [[nodiscard]] std::filesystem::path new_file(const std::string& name);
  /// A file for the waves of a repeated failure.
  [[nodiscard]] NamelessFile whole_waves() const { return {made_->descriptor(), folder_}; }
  /// Contents of fail.json.
  [[nodiscard]] nlohmann::ordered_json& json() { return json_; }
  /// Adds a section to fail.txt.
  void add(std::string_view heading, std::string_view text);
  void write(const std::string& name, std::string_view text);
  /// Writes fail.json and fail.txt.
  void finish();
  /// Error kFile if the folder's name leads elsewhere by now.
  void check() const;

 private:
  std::optional<OutputFolder> made_;
  std::list<NameInFolder> written_;  ///< removed again without finish()
  std::filesystem::path folder_;     ///< as named
  nlohmann::ordered_json json_;
  std::vector<std::string> sections_;  ///< of fail.txt
};

/// Creates the folder, packs the failure into it, and returns its path. What cannot be packed is
/// named in fail.json and in `missing`. Errors as in Bundle.
struct Packed {
  std::filesystem::path folder;
  std::string missing;
};
[[nodiscard]] Packed pack(const std::string& folder, const Failure& failure);

/// Cuts the waves `whole` to waves.fst and waves.gtkw in the bundle. They
/// cover `before` cycles ahead of `fail` and `behind` cycles after it. `shown` are the signals that
/// GTKWave shows first, as `cde wave show` takes them; missing ones are left out.
/// `json["wave_window"]` describes the window.
struct WaveWindow {
  std::uint64_t fail = 0;  ///< in time units of the file
  std::uint64_t before = 40, behind = 10;
  std::vector<std::string> shown = {};
  std::vector<std::string> first = {};  ///< words of `shown` for a command that looks at the waves
  std::string what = "the wrong answer";  ///< what happens at `fail`
};
void cut_waves(Bundle& bundle, const std::filesystem::path& whole, const WaveWindow& window);

void bundle_pair(Bundle& bundle, const Failure& failure);
void bundle_card(Bundle& bundle, const Failure& failure);
void bundle_hang(Bundle& bundle, const Failure& failure);

/// Adds the explanation of a pair: explain.txt, `json["first_differences"]` and a section of
/// fail.txt. False if the pipe alone agrees with the reference.
bool bundle_explanation(Bundle& bundle, const explain::Explanation& explanation,
                        const std::string& options, const std::string& words);

/// Where the word that `signal` has at a time of the waves in `file` was produced. If that is
/// unknown: the signal itself at that time.
[[nodiscard]] wave::Origin origin_at(const std::filesystem::path& file, const std::string& signal,
                                     std::uint64_t time);

/// Adds why.txt: what caused the value of `signal` at the failure, with source lines. `made` says
/// where the value was produced, in waves.fst. `signal` is written as `cde wave why` takes it.
void bundle_causes(Bundle& bundle, const std::string& signal, const wave::Origin& made);

/// Results with words as hexfloats.
[[nodiscard]] nlohmann::ordered_json result_json(const FpFormat& format, const PairResult& result);
[[nodiscard]] nlohmann::ordered_json record_json(const std::optional<Record>& record);

}  // namespace cde
