// SPDX-License-Identifier: Apache-2.0
#include "verbs/run_frames.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "cde/card/json_keys.hpp"
#include "cde/model/model.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

Json query_json(const std::string& name, const QueryFrame& f) {
  Json counters = counters_json(f.counters);
  counters.update({{"card_records", f.card_records},
                   {"secondary_words", f.secondary_words},
                   {"primary_words", f.primary_words},
                   {"secondary_upload_cycles", f.secondary_cycles},
                   {"primary_upload_cycles", f.primary_cycles},
                   {"download_cycles", f.download_cycles}});
  return {
      {"query", name},
      {"passes", f.passes},
      {"brute_force_reason", f.brute_force_reason.empty() ? Json() : Json(f.brute_force_reason)},
      {"records", f.counters.records},
      {"hits", f.hits},
      {"records_compared", f.compared},
      {"records_matching", f.compared - std::min(f.compared, f.mismatches)},
      {"mismatches", f.mismatches},
      {"counters", counters},
      {"modelled_seconds", time_json(f.time())},
      {"simulation_seconds", f.pass_seconds},
      {"reference_seconds", f.check_seconds}};
}

/// Runs a frame on a rank. Returns a line of JSON with the lengths of the texts, then the texts of
/// the records.
std::string run_frame(SceneRunner& runner, const DistributedFrames& f, std::uint32_t frame) {
  const Scene& scene = f.scene;
  std::vector<std::string> texts(scene.results == Results::kNone ? 0 : scene.queries.size());
  const auto start = std::chrono::steady_clock::now();
  const std::vector<QueryFrame> answers =
      runner.run_frame(frame, [&](std::size_t q, std::span<const Record> records) {
        if (!texts.empty())
          record_text(scene, scene.queries[q], f.files).append(records, texts[q], frame);
      });
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  for (std::size_t q = 0; q < answers.size(); ++q)
    if (answers[q].mismatches != 0)
      throw Error(ErrorCode::kMismatch, mismatch_text(scene, frame, q, answers[q],
                                                      repeat_of(scene, frame, f.check), false));
  Json sizes = Json::array();
  for (const std::string& text : texts) sizes.push_back(text.size());
  std::string all =
      json_text(Json{{"frame", frame_json(scene, frame, wall.count(),
                                          frame_names(scene, frame, f.files), answers)},
                     {"sizes", sizes}},
                -1) +
      "\n";
  for (const std::string& text : texts) all += text;
  return all;
}

/// Checks that a value has the members of another, with values of the same kinds.
void check_members(const Json& json, const Json& wanted) {
  if (wanted.is_object())
    for (const auto& [key, value] : wanted.items()) check_members(json.at(key), value);
  else if (wanted.is_array() && (!json.is_array() || json.size() != wanted.size()))
    throw Error(ErrorCode::kFile, fmt::format("a list in it is {} instead of {} entries",
                                              json_text(json, -1), wanted.size()));
  else if (wanted.is_array())
    for (std::size_t i = 0; i < wanted.size(); ++i) check_members(json.at(i), wanted.at(i));
  else if (wanted.is_number_unsigned() ? !json.is_number_unsigned()
           : wanted.is_null()          ? !json.is_null() && !json.is_string()
           : wanted.is_number()        ? !json.is_number()
                                       : json.type() != wanted.type())
    throw Error(ErrorCode::kFile, fmt::format("a value in it is {} instead of one such as {}",
                                              json_text(json, -1), json_text(wanted, -1)));
}

/// A frame as run_frame() returns it.
struct FrameResult {
  Json frame;
  std::vector<std::string> records;
};
FrameResult frame_in(const std::string& result) {
  const std::size_t line = result.find('\n') + 1;
  const Json head = parse_json(result.substr(0, line));
  FrameResult all{head.at("frame"), {}};
  std::size_t at = line;
  for (const Json& number : head.at("sizes")) {
    const auto size = number.get<std::size_t>();
    if (size > result.size() - at)
      throw Error(ErrorCode::kFile, fmt::format("it states records of {} bytes; {} bytes follow",
                                                size, result.size() - at));
    all.records.push_back(result.substr(at, size));
    at += size;
  }
  if (at != result.size())
    throw Error(ErrorCode::kFile, fmt::format("{} bytes follow its records", result.size() - at));
  return all;
}

/// A digest of the scene and of the shapes that were read from its files. No file is read again: a
/// pipe is at its end by now, and another file may have changed.
std::string contents(const Scene& scene) {
  std::string all = scene.digest;
  const auto add = [&all](const auto& list) {
    all += fingerprint({reinterpret_cast<const char*>(list.data()), list.size() * sizeof list[0]});
  };
  for (const SceneObject& object : scene.objects) {
    if (object.file.empty()) continue;
    std::visit(
        [&](const auto& list) {
          std::vector<std::array<float, std::decay_t<decltype(list)>::value_type::kWords>> words;
          for (const auto& shape : list) words.push_back(to_words(shape));
          add(words);
        },
        object.shapes);
    if (!object.mesh) continue;
    add(object.mesh->vertices);
    add(object.mesh->faces);
  }
  return fingerprint(all);
}

}  // namespace

Json frame_json(const Scene& scene, std::uint32_t frame, double wall_seconds,
                const std::vector<std::string>& files, const std::vector<QueryFrame>& answers) {
  Json j = {{"frame", frame},
            {"scene_seconds", seconds(scene, frame)},
            {"wall_seconds", wall_seconds},
            {"files", files},
            {"queries", Json::array()}};
  for (std::size_t q = 0; q < answers.size(); ++q)
    j["queries"].push_back(query_json(scene.queries[q].name, answers[q]));
  return j;
}

std::string repeat_of(const Scene& scene, std::uint32_t frame, Check check) {
  return fmt::format("cde run {} --frames {}..{} --check {}", shell_word(scene.file), frame, frame,
                     name_of(check));
}

std::string mismatch_text(const Scene& scene, std::uint32_t frame, std::size_t query,
                          const QueryFrame& answer, const std::string& repeat, bool faults) {
  return fmt::format(
      "frame {}, query '{}': {} of {} {} from the reference, the first:\n{}"
      "\n{}the frame again: {}",
      frame, scene.queries[query].name, answer.mismatches, counted(answer.compared, "record"),
      answer.mismatches == 1 ? "differs" : "differ", answer.first_mismatch,
      faults ? "faults were injected; the command above repeats the pair without them\n" : "",
      repeat);
}

void begin_frames(const DistributionOptions& options, const DistributedFrames& f, bool quiet) {
  WorkDistributor& distributor = WorkDistributor::instance();
  Json run = {{"verb", "run"},
              {"scene", fmt::format("contents {}", contents(f.scene))},
              {"frames", {f.first, f.last}},
              {"check", name_of(f.check)},
              {"file_per_frame", f.files == RecordFiles::kPerFrame},
              {"parameters", f.plan.board.parameters()}};
  if (!distributor.merges())
    run["config_hash"] =
        fmt::format("{:016x}", model_hash(f.plan.board.top(), f.plan.board.parameters()));
  distributor.begin(options, run, quiet);
}

bool distribute_frames(const DistributedFrames& f, const FrameSink& take) {
  std::optional<SceneRunner> runner;
  const std::uint64_t frames = f.last - f.first + 1;
  return WorkDistributor::instance().run_part(
      {.what = "simulating",
       .chunks = frames,
       .input = [&](std::uint64_t c) -> std::optional<std::string> {
         if (c >= frames) return std::nullopt;
         return fmt::format("frame {}", f.first + c);
       },
       .run =
           [&](std::uint64_t c, const std::string&) {
             if (!runner)
               runner.emplace(f.scene, f.plan,
                              RunnerOptions{.check = f.check,
                                            .watchdog = std::chrono::duration<double>(f.timeout),
                                            .deadline_cycles = f.deadline});
             return run_frame(*runner, f, f.first + static_cast<std::uint32_t>(c));
           },
       .check =
           [&](std::uint64_t c, const std::string& result) {
             const FrameResult one = frame_in(result);
             const auto frame = f.first + static_cast<std::uint32_t>(c);
             const std::size_t queries = f.scene.queries.size();
             check_members(one.frame,
                           frame_json(f.scene, frame, 0.0, frame_names(f.scene, frame, f.files),
                                      std::vector<QueryFrame>(queries)));
             if (one.records.size() != (f.scene.results == Results::kNone ? 0 : queries))
               throw Error(ErrorCode::kFile, fmt::format("it has records of {} queries; the scene "
                                                         "has {}",
                                                         one.records.size(), queries));
           },
       .take =
           [&](std::uint64_t c, const std::string& result) {
             const FrameResult one = frame_in(result);
             take(f.first + static_cast<std::uint32_t>(c), one.frame, one.records);
           }});
}

}  // namespace cde::cli
