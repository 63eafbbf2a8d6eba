// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/packet_again.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cde/contract/records.hpp"
#include "cde/scene/scene_pair.hpp"

namespace cde {
namespace {

/// Plays the frames and traces the packet. Returns whether the record is the same.
bool run_again(const RunFailure& f, std::uint32_t first, const std::string& file,
               const TraceOptions& which) {
  const auto& wanted = f.difference.card;
  bool found = false, there = false;
  (void)run_packet({f.scene, f.plan, f.options, f.frame, f.query, f.difference.number()}, first,
                   file, which, [&](std::span<const Record> records) {
                     for (const Record& r : records) {
                       const bool same_place =
                           r.primary == f.difference.number() &&
                           (!f.difference.reference || r.index == f.difference.reference->index);
                       there = there || same_place;
                       found = found || (wanted && same_bits(r, *wanted));
                     }
                   });
  return wanted ? found : !there;
}

}  // namespace

QueryFrame run_packet(const PacketAgain& p, std::uint32_t first, const std::string& file,
                      const TraceOptions& which, const RecordSink& sink) {
  Plan plan = p.plan;
  plan.board.trace = true;
  RunnerOptions options = p.options;
  options.trace = file;
  options.waves = which;
  options.waves_of = {p.frame, p.query, p.primary / card::kMostPrimaries};
  SceneRunner runner(p.scene, plan, options);
  QueryFrame last;
  for (std::uint32_t frame = first; frame <= p.frame; ++frame)
    last = runner
               .run_frame(frame,
                          [&](std::size_t query, std::span<const Record> records) {
                            if (frame == p.frame && query == p.query) sink(records);
                          })
               .at(p.query);
  runner.trace_close();
  return last;
}

Failure failure_of(const RunFailure& r) {
  const SceneQuery& query = r.scene.queries[r.query];
  CardFailure f;
  const BoardConfig& board = r.plan.board;
  const PassPipe pipe = pipe_of(query, board);
  f.pipe = pipe.config;
  f.iterations = pipe.iterations;
  f.swap = query.swap;
  f.mode = query.mode;
  f.difference = r.difference;
  f.place = r.difference.number() % card::kMostPrimaries;
  const auto work = std::find_if(r.plan.queries.begin(), r.plan.queries.end(),
                                 [&](const QueryWork& w) { return w.name == query.name; });
  f.cycles =
      work == r.plan.queries.end() ? 0 : work->secondaries * (card::kMostPrimaries / board.lanes);
  Failure failure{.kind = f, .message = r.message, .repeat = r.repeat};
  failure.details =
      nlohmann::ordered_json{{"scene", r.scene.file}, {"frame", r.frame}, {"query", query.name}}
          .dump();
  failure.rerun = [r](const std::string& file, const TraceOptions& which) {
    if (run_again(r, r.frame, file, which)) return true;
    if (r.first == r.frame) return false;
    std::filesystem::remove(file);
    return run_again(r, r.first, file, which);
  };
  return failure;
}

}  // namespace cde
