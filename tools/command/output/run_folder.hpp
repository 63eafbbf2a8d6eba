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
#include "cde/support/folder_lock.hpp"
#include "cde/support/output_file.hpp"

namespace cde::cli {

/// The folder of `cde run`. It holds run.json, the records of one run and, if requested, its page
/// and waves. The file run.json is there from the first frame on, and marks the folder of a
/// run. The folder is locked while the object lives, by its file run.lock. The system releases the
/// lock when the process ends, in any way.
class RunFolder {
 public:
  /// Makes the folder if it does not exist. Error kUsage if it is neither empty nor the folder of a
  /// run, or if another process uses it; the message names what is there. Error kUsage if it
  /// contains a file of the scene, or a file of an earlier run that belongs to another user. Error
  /// kUsage if one of `beside` (--report, --trace) has the name
  /// of a file of the run.
  RunFolder(std::filesystem::path path, const Scene& scene, const std::vector<std::string>& beside);

  /// Removes the earlier run in the folder and begins this one.
  void begin(nlohmann::ordered_json json);
  [[nodiscard]] bool begun() const { return begun_; }

  /// Writes run.json, once the run has begun.
  void write(const nlohmann::ordered_json& json) const;

  /// Error kFile if the path now leads to another folder.
  void check() const { made_->check(); }

  /// run.json of a folder; null if it is not the folder of a run.
  [[nodiscard]] static nlohmann::ordered_json run_in(const std::filesystem::path& folder);
  /// The name of the file with a query's records of a frame, or of its table of all frames.
  [[nodiscard]] static std::string record_name(std::string_view query,
                                               std::optional<std::uint32_t> frame, Results results);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// A path to the locked folder itself, whatever its name leads to now. Files are opened through
  /// it.
  [[nodiscard]] std::filesystem::path inside() const;
  /// The names of --report and --trace if they are in the folder: `files_beside` in run.json.
  [[nodiscard]] const std::vector<std::string>& beside() const { return beside_; }

 private:
  /// The folder, open, and the lock of the process that uses it.
  struct Lock {
    Lock() = default;
    ~Lock() { release(); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    void release();
    int folder = -1;  ///< descriptor, or -1
    FolderLock file;
  };
  void make_and_lock();
  void check_owner(const std::string& name) const;
  void check_names(const Scene& scene, const std::vector<std::string>& beside);
  void look();
  std::filesystem::path path_;
  std::vector<std::string> beside_;   ///< names of --report and --trace in this folder
  std::vector<std::string> old_;      ///< names of the files of the earlier run
  std::optional<OutputFolder> made_;  ///< removed again if no run begins
  Lock lock_;                         ///< its file is removed before the folder
  bool begun_ = false;
};

}  // namespace cde::cli
