// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/scene/scene.hpp"
#include "cde/support/output_file.hpp"

namespace cde::cli {

/// The folder of `cde run`: it holds the run.json and the records of one run, and nothing else but
/// a page and waves that the run was told to put there. run.json is there from the first frame on
/// and tells such a folder from others. It is locked while the object lives; the system lets go of
/// the lock when the process ends, however it does.
class RunFolder {
 public:
  /// Makes it if it is not there. Error kUsage, naming what is there, unless it is empty or a
  /// run's and no other process runs into it; kUsage if something of the scene is in it, or if one
  /// of the `beside` (--report,
  /// --trace) would have the name of a file of the run.
  RunFolder(std::filesystem::path path, const Scene& scene, const std::vector<std::string>& beside);

  /// Removes the run that was there, and from now on there is this one.
  void begin(nlohmann::ordered_json json);
  [[nodiscard]] bool begun() const { return begun_; }

  /// run.json. Once the run has begun.
  void write(const nlohmann::ordered_json& json) const;

  /// Error kFile if its name leads elsewhere by now.
  void check() const { made_->check(); }

  /// run.json of a folder; null if it is not that of a run.
  [[nodiscard]] static nlohmann::ordered_json run_in(const std::filesystem::path& folder);
  /// The file of a query's records of a frame, or its table of all frames.
  [[nodiscard]] static std::string record_name(std::string_view query,
                                               std::optional<std::uint32_t> frame, Results results);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The folder as it was locked, whatever lies under its name now: where its files are opened.
  [[nodiscard]] std::filesystem::path inside() const;
  /// The names of --report and --trace if they are in the folder: `files_beside` in run.json.
  [[nodiscard]] const std::vector<std::string>& beside() const { return beside_; }

 private:
  /// Held by the process that runs into the folder.
  struct Lock {
    Lock() = default;
    ~Lock() { release(); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    void release();
    int folder = -1;  ///< opened, or -1
  };
  void make_and_lock();
  void check_names(const Scene& scene, const std::vector<std::string>& beside);
  void look();
  std::filesystem::path path_;
  std::vector<std::string> beside_;   ///< names in this folder that are the run's, too
  std::vector<std::string> old_;      ///< names of the files of the run that was there
  Lock lock_;                         ///< outlives made_
  std::optional<OutputFolder> made_;  ///< taken away again if no run begins
  bool begun_ = false;
};

}  // namespace cde::cli
