// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/io/record_file.hpp"
#include "cde/scene/scene.hpp"

namespace cde::cli {

/// The files for the records of a run.
enum class RecordFiles {
  kTables,    ///< one file per query; the first column is the frame
  kPerFrame,  ///< one file per query and frame
};

/// The format of the records of a query, from the scene.
[[nodiscard]] RecordText record_text(const Scene& scene, const SceneQuery& query,
                                     RecordFiles files);

/// Names of the tables, by query; empty if the scene writes no records, or with kPerFrame.
[[nodiscard]] std::vector<std::string> table_names(const Scene& scene, RecordFiles files);
/// Names of the files of a frame, by query; empty if there are none.
[[nodiscard]] std::vector<std::string> frame_names(const Scene& scene, std::uint32_t frame,
                                                   RecordFiles files);

/// The record files of a run, written as records arrive. Tables appear at commit(), files of a
/// frame at end_frame(). Unfinished files are removed with the object.
class RunRecords {
 public:
  RunRecords(const Scene& scene, RecordFiles files) : scene_(scene), kind_(files) {}
  /// Opens the tables in `folder`.
  void begin(std::filesystem::path folder);
  void begin_frame(std::uint32_t frame);
  void add(std::size_t query, std::span<const Record> records);
  /// Adds text of the frame's records that RecordText::append has written.
  void add_text(std::size_t query, std::string_view text);
  void end_frame();
  void commit();  ///< error kFile if anything could not be written

 private:
  void open(const std::vector<std::string>& names);

  const Scene& scene_;
  RecordFiles kind_;
  std::filesystem::path folder_;
  std::uint32_t frame_ = 0;
  std::vector<std::unique_ptr<RecordFile>> files_;  ///< by query; empty if no records are written
};

}  // namespace cde::cli
