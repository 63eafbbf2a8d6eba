// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/scene_accuracy.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/progress.hpp"

namespace cde::accuracy {
namespace {

constexpr FpFormat kFp64{11, 52};
constexpr std::uint32_t kNone = ~0u;
constexpr double kTieBand = 16;  // in u

/// Shapes as words of a format, one after the other.
struct Words {
  std::size_t each = 0;
  std::vector<std::uint64_t> all;
  [[nodiscard]] std::span<const std::uint64_t> of(std::size_t i) const {
    return std::span(all).subspan(i * each, each);
  }
};

Shapes world_shapes(const cde::Scene& scene, const SceneObject& object, std::uint32_t frame) {
  const Shapes local = local_shapes(scene, object, frame);
  if (has_member_poses(object)) return posed(local, member_poses(scene, object, frame));
  return posed(local, pose(scene, object, frame));
}

std::vector<Shapes> shapes_of(const cde::Scene& scene, const std::vector<std::size_t>& objects,
                              std::uint32_t frame) {
  std::vector<Shapes> all;
  for (const std::size_t i : objects) all.push_back(world_shapes(scene, scene.objects[i], frame));
  return all;
}

Words words_in(FpFormat format, const std::vector<Shapes>& objects) {
  Words words;
  words.each = cde::words(shape_of(objects.front()));
  for (const Shapes& shapes : objects)
    for (std::size_t i = 0; i < size(shapes); ++i)
      for (const float x : numbers_of(shapes, i)) words.all.push_back(format.encode(x));
  return words;
}

/// Tests one primary with all secondaries in a format.
class Tester {
 public:
  Tester(const SceneQuery& query, const SceneCard& card, FpFormat format,
         const std::vector<Shapes>& primaries, const std::vector<Shapes>& secondaries)
      : query_(query),
        card_(card),
        format_(format),
        primaries_(words_in(format, primaries)),
        secondaries_(words_in(format, secondaries)),
        results_(secondaries_.all.size() / secondaries_.each) {}

  void test(std::size_t primary) {
    const auto one = primaries_.of(primary);
    repeated_.clear();
    for (std::size_t i = 0; i < results_.size(); ++i)
      repeated_.insert(repeated_.end(), one.begin(), one.end());
    const bool swap = query_.swap;
    reference::test_pairs(query_.pair, card_.algorithm, format_,
                          swap ? secondaries_.all : repeated_, swap ? repeated_ : secondaries_.all,
                          results_, PlaneSide::kSurface, query_.iterations,
                          query_.pair == Pair::kRayTriangle && card_.box);
  }

  [[nodiscard]] std::size_t secondaries() const { return results_.size(); }
  [[nodiscard]] std::size_t primaries() const { return primaries_.all.size() / primaries_.each; }
  [[nodiscard]] const PairResult& result(std::size_t s) const { return results_[s]; }
  /// T; for solids this is the signed distance.
  [[nodiscard]] double signed_t(std::size_t s) const {
    const double t = format_.decode(results_[s].t);
    return is_solid(query_.pair) && results_[s].f ? -t : t;
  }
  /// The secondary that a mode with one record per primary keeps.
  [[nodiscard]] std::uint32_t kept() const {
    std::uint32_t best = kNone;
    for (std::uint32_t s = 0; s < results_.size(); ++s) {
      const PairResult& r = results_[s];
      if (r.bad || (!r.f && (!is_solid(query_.pair) || query_.mode == Mode::kAny))) continue;
      if (best == kNone) best = s;
      if (query_.mode == Mode::kAny) break;
      if (query_.mode == Mode::kNearest ? signed_t(s) < signed_t(best)
                                        : signed_t(s) > signed_t(best))
        best = s;
    }
    return best;
  }

 private:
  const SceneQuery& query_;
  const SceneCard& card_;
  FpFormat format_;
  Words primaries_, secondaries_;
  std::vector<PairResult> results_;
  std::vector<std::uint64_t> repeated_;
};

class RecordChecker {
 public:
  RecordChecker(SceneAccuracy& row, const Tester& truth, const Tester& seen)
      : row_(row), truth_(truth), seen_(seen) {}

  void pairs() {
    for (std::size_t s = 0; s < truth_.secondaries(); ++s) {
      ++row_.records;
      const PairResult &is = truth_.result(s), &saw = seen_.result(s);
      row_.hits += saw.f ? 1 : 0;
      if (saw.bad || is.bad)
        ++row_.refused;
      else if (decide(is.f, saw.f))
        error(s, s);
    }
  }

  void kept() {
    ++row_.records;
    const std::uint32_t is = truth_.kept(), saw = seen_.kept();
    if (refused()) {
      ++row_.refused;
      return;
    }
    const bool hit = saw != kNone && seen_.result(saw).f;
    row_.hits += hit ? 1 : 0;
    if (!decide(is != kNone && truth_.result(is).f, hit) || is == kNone || saw == kNone) return;
    error(is, saw);
    if (is == saw) return;
    const double u = std::ldexp(1, -1 - row_.format.man_bits);
    const double apart = std::abs(truth_.signed_t(saw) - truth_.signed_t(is));
    ++(apart <= kTieBand * u * std::abs(truth_.signed_t(is)) ? row_.ties : row_.other);
  }

 private:
  /// Whether every pair of the primary was refused.
  [[nodiscard]] bool refused() const {
    for (std::size_t s = 0; s < seen_.secondaries(); ++s)
      if (!seen_.result(s).bad) return false;
    return true;
  }
  bool decide(bool is, bool saw) {
    if (is == saw) return true;
    ++(saw ? row_.false_hits : row_.false_misses);
    return false;
  }
  void error(std::size_t is, std::size_t saw) {
    const double t = truth_.signed_t(is), seen = seen_.signed_t(saw);
    if (std::isfinite(t) && t != 0) row_.t.add(std::abs(seen - t) / std::abs(t));
  }

  SceneAccuracy& row_;
  const Tester& truth_;
  const Tester& seen_;
};

std::uint64_t cycles_per_row(const SceneQuery& query, const BoardConfig& board) {
  const unsigned passes = reference::passes(query.pair, query.iterations);
  return passes != 0 ? passes : has_sat_interval(query.pair) ? board.sat_interval : 1;
}

void check_queries(const cde::Scene& scene) {
  for (const SceneQuery& q : scene.queries)
    for (const std::size_t object : q.primaries)
      if (std::find(q.secondaries.begin(), q.secondaries.end(), object) != q.secondaries.end())
        throw Error(ErrorCode::kUsage,
                    fmt::format("{}: query '{}' has object '{}' on both sides; the accuracy of "
                                "pairs of an object with itself is not measured",
                                printable_name(scene.file), q.name, scene.objects[object].name));
}

nlohmann::ordered_json row_json(const SceneAccuracy& row, double clock_hz) {
  const auto quantile = [&](double share) {
    return row.t.count() == 0 ? 0 : row.t.quantile(share);
  };
  return {{"format", row.format.name()},
          {"frame", row.frame},
          {"query", row.query},
          {"records", row.records},
          {"hits", row.hits},
          {"refused", row.refused},
          {"false_hits", row.false_hits},
          {"false_misses", row.false_misses},
          {"other_secondaries", row.other},
          {"tied_secondaries", row.ties},
          {"relative_t_error",
           {{"count", row.t.count()},
            {"median", quantile(0.5)},
            {"p99", quantile(0.99)},
            {"largest", row.t.count() == 0 ? 0 : row.t.largest()}}},
          {"rows", row.rows},
          {"modelled_row_seconds", static_cast<double>(row.rows) / clock_hz}};
}

}  // namespace

std::vector<SceneAccuracy> scene_accuracy(const cde::Scene& scene, const Plan& plan,
                                          const SceneAccuracyOptions& options) {
  check_queries(scene);
  Progress progress("scene", options.quiet);
  const double steps = static_cast<double>(options.last - options.first + 1) *
                       static_cast<double>(scene.queries.size() * options.formats.size());
  double done = 0;
  std::vector<SceneAccuracy> all;
  for (std::uint32_t frame = options.first; frame <= options.last; ++frame) {
    for (std::size_t k = 0; k < scene.queries.size(); ++k) {
      const SceneQuery& q = scene.queries[k];
      const auto primaries = shapes_of(scene, q.primaries, frame),
                 secondaries = shapes_of(scene, q.secondaries, frame);
      Tester truth(q, scene.card, kFp64, primaries, secondaries);
      std::vector<Tester> formats;
      const std::size_t first = all.size();
      for (const FpFormat format : options.formats) {
        formats.emplace_back(q, scene.card, format, primaries, secondaries);
        all.push_back({.format = format, .frame = frame, .query = q.name});
        all.back().rows = plan.queries[k].rows * cycles_per_row(q, plan.board);
      }
      for (std::size_t p = 0; p < truth.primaries(); ++p) {
        const double share = static_cast<double>(p) / static_cast<double>(truth.primaries());
        progress((done + share * static_cast<double>(formats.size())) / steps);
        if (contains(q.mask, p)) continue;
        truth.test(p);
        for (std::size_t f = 0; f < formats.size(); ++f) {
          formats[f].test(p);
          RecordChecker checker(all[first + f], truth, formats[f]);
          q.mode == Mode::kAll || q.mode == Mode::kHits ? checker.pairs() : checker.kept();
        }
      }
      done += static_cast<double>(formats.size());
    }
  }
  return all;
}

nlohmann::ordered_json scene_accuracy_json(const std::vector<SceneAccuracy>& rows,
                                           double clock_hz) {
  auto all = nlohmann::ordered_json::array();
  for (const SceneAccuracy& row : rows) all.push_back(row_json(row, clock_hz));
  return all;
}

}  // namespace cde::accuracy
