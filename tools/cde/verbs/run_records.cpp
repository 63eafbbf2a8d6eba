// SPDX-License-Identifier: Apache-2.0
#include "verbs/run_records.hpp"

#include <optional>
#include <utility>

#include "cde/scene/inside.hpp"
#include "output/run_folder.hpp"

namespace cde::cli {
namespace {

RecordFormat::Kind kind_of(Results results) {
  if (results == Results::kBinary) return RecordFormat::Kind::kWords;
  return results == Results::kNpy ? RecordFormat::Kind::kNpy : RecordFormat::Kind::kCsv;
}

std::vector<std::string> names(const Scene& scene, std::optional<std::uint32_t> frame) {
  std::vector<std::string> all;
  if (scene.results == Results::kNone) return all;
  for (const SceneQuery& query : scene.queries)
    all.push_back(RunFolder::record_name(query.name, frame, scene.results));
  return all;
}

}  // namespace

RecordText record_text(const Scene& scene, const SceneQuery& query, RecordFiles files) {
  RecordFormat format{.kind = kind_of(scene.results),
                      .frame = files == RecordFiles::kTables,
                      .scene = true,
                      .normals = query.normals,
                      .bits = scene.bits && scene.results == Results::kCsv,
                      .only_hits = scene.only_hits};
  if (!query.inside) return RecordText(std::move(format));
  format.fields = {RecordField::kInside};
  return {std::move(format),
          [inside = std::make_shared<SceneInside>(scene, query)](
              std::uint32_t frame, std::uint32_t primary) { return inside->of(frame)[primary]; }};
}

std::vector<std::string> table_names(const Scene& scene, RecordFiles files) {
  if (files != RecordFiles::kTables) return {};
  return names(scene, std::nullopt);
}

std::vector<std::string> frame_names(const Scene& scene, std::uint32_t frame, RecordFiles files) {
  if (files != RecordFiles::kPerFrame) return {};
  return names(scene, frame);
}

void RunRecords::open(const std::vector<std::string>& names) {
  files_.clear();
  for (std::size_t q = 0; q < names.size(); ++q)
    files_.push_back(std::make_unique<RecordFile>(folder_ / names[q],
                                                  record_text(scene_, scene_.queries[q], kind_)));
}

void RunRecords::begin(std::filesystem::path folder) {
  folder_ = std::move(folder);
  open(table_names(scene_, kind_));
}

void RunRecords::begin_frame(std::uint32_t frame) {
  frame_ = frame;
  if (kind_ == RecordFiles::kPerFrame) open(frame_names(scene_, frame, kind_));
}

void RunRecords::add(std::size_t query, std::span<const Record> records) {
  if (!files_.empty()) files_[query]->add(records, frame_);
}

void RunRecords::add_text(std::size_t query, std::string_view text) {
  if (!files_.empty()) files_[query]->add_text(text);
}

void RunRecords::end_frame() {
  if (kind_ == RecordFiles::kPerFrame) commit();
}

void RunRecords::commit() {
  for (const auto& file : files_) file->commit();
  files_.clear();
}

}  // namespace cde::cli
