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

/// What a run writes its records to.
enum class RecordFiles {
  kTables,    ///< a file per query, whose first column is the frame
  kPerFrame,  ///< a file per query and frame
};

/// How the records of a query are written, as the scene says.
[[nodiscard]] RecordText record_text(const Scene& scene, const SceneQuery& query,
                                     RecordFiles files);

/// Names of the tables, by query; none if the scene writes no records or they go to files per
/// frame.
[[nodiscard]] std::vector<std::string> table_names(const Scene& scene, RecordFiles files);
/// Names of a frame's own files, by query; none if there are none.
[[nodiscard]] std::vector<std::string> frame_names(const Scene& scene, std::uint32_t frame,
                                                   RecordFiles files);

/// The files of records of a run, written as records come. Tables are there after commit(), files
/// of a frame after end_frame(); those that are not whole are removed with the object.
class RunRecords {
 public:
  RunRecords(const Scene& scene, RecordFiles files) : scene_(scene), kind_(files) {}
  /// Opens the tables.
  void begin(std::filesystem::path folder);
  void begin_frame(std::uint32_t frame);
  void add(std::size_t query, std::span<const Record> records);
  /// Adds what RecordText::append has written of the frame's records.
  void add_text(std::size_t query, std::string_view text);
  void end_frame();
  void commit();  ///< error kFile if anything could not be written

 private:
  void open(const std::vector<std::string>& names);

  const Scene& scene_;
  RecordFiles kind_;
  std::filesystem::path folder_;
  std::uint32_t frame_ = 0;
  std::vector<std::unique_ptr<RecordFile>> files_;  ///< by query; none if records are not written
};

}  // namespace cde::cli
