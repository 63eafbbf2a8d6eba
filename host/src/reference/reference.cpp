// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "cde/contract/records.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "cde/support/error.hpp"
#include "query/record_choice.hpp"
#include "reference/ray_block.hpp"

namespace cde::reference {

Record record_of(const Ray& ray, const Triangle& triangle, std::uint32_t primary,
                 std::uint32_t index, bool box, Algorithm algorithm) {
  const Outcome<float> outcome = ray_triangle_test<float>(algorithm, box)(ray, triangle);
  Record r;
  r.f = outcome.f;
  r.bad = outcome.bad;
  r.t = outcome.t;
  r.cp = outcome.cp;
  r.index = outcome.f ? index : ~0u;
  r.primary = primary;
  return r;
}

bool has_fast_brute_force(Algorithm algorithm, FpFormat format) {
  return format == FpFormat{} && inside_test(algorithm) != nullptr;
}

/// Works on one packet at a time. A reduction returns all records of a packet at once; a stream
/// returns the records of one triangle at a time.
class BruteForce::Impl {
 public:
  Impl(const RayView& rays, const TriangleView& triangles, Mode mode, const Stencil& stencil,
       unsigned packet, std::span<const Object> objects, bool box, FpFormat format,
       Algorithm algorithm)
      : packet_(packet),
        rays_(rays),
        triangles_(triangles),
        stencil_(stencil),
        mode_(mode),
        box_(box),
        format_(format),
        algorithm_(algorithm),
        inside_(inside_test(algorithm)),
        any_(!has_fast_brute_force(algorithm, format)) {
    (void)name_of(mode);  // throws for an unknown mode
    if (packet == 0 || packet > RayBlock::kRays)
      throw Error(ErrorCode::kUsage,
                  fmt::format("a packet of {} rays; expected 1 to {}", packet, RayBlock::kRays));
    for (const Object& object : objects)
      if (object.first > triangles.size() || object.count > triangles.size() - object.first)
        throw Error(ErrorCode::kUsage,
                    fmt::format("an object of {} triangles from {} on exceeds the {}", object.count,
                                object.first, triangles.size()));
    if (!objects.empty() || any_) secondaries_ = pass_secondaries(triangles, objects, format);
    if (!objects.empty()) triangles_ = TriangleView(secondaries_.shapes);
    if (any_) {
      words_ = std::move(secondaries_.shapes);
      triangles_ = TriangleView(std::get<std::vector<Triangle>>(words_));
    }
    begin_packet();
  }

  std::span<const Record> next() {
    records_.clear();
    if (any_) return next_of_pass();
    while (records_.empty() && first_ < rays_.size()) {
      if (!streaming()) {
        reduce();
      } else {
        if (triangle_ < triangles_.size()) stream(static_cast<std::uint32_t>(triangle_));
        if (++triangle_ < triangles_.size()) continue;
      }
      first_ += packet_;
      begin_packet();
    }
    return records_;
  }

 private:
  void begin_packet() {
    triangle_ = 0;
    block_ = {};
    if (first_ >= rays_.size()) return;
    packet_rays_ = rays_.subview(first_, packet_).copy();
    if (any_) return begin_pass();
    for (std::size_t i = 0; i < packet_rays_.size(); ++i) block_.set(i, packet_rays_[i]);
    block_.count = static_cast<unsigned>(packet_rays_.size());
  }

  [[nodiscard]] bool streaming() const { return mode_ == Mode::kAll || mode_ == Mode::kHits; }

  // ---- Other formats and algorithms: the general reference tests a packet ----

  void begin_pass() {
    std::vector<Ray> rays;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < packet_rays_.size(); ++i) {
      if (stencil_[i]) continue;
      rays.push_back(packet_rays_[i]);
      numbers.push_back(number(i));
    }
    pass_.emplace(PassQuery{.algorithm = algorithm_,
                            .box = box_,
                            .mode = streaming() ? mode_ : Mode::kHits,
                            .format = format_},
                  std::move(rays), std::move(numbers), words_);
  }

  std::span<const Record> next_of_pass() {
    while (records_.empty() && first_ < rays_.size()) {
      const std::span<const Record> some = streaming() ? pass_->next() : reduced();
      records_.assign(some.begin(), some.end());
      if (streaming() && !some.empty()) {
        for (Record& r : records_)
          if (r.index != ~0u) r.index = slot(r.index);
        continue;
      }
      first_ += packet_;
      begin_packet();
    }
    return records_;
  }

  /// One record per ray. Ties go by the slots of the triangles, which objects may test in any
  /// order.
  std::span<const Record> reduced() {
    std::vector<std::size_t> places(packet_rays_.size());
    best_.clear();
    for (std::size_t i = 0; i < packet_rays_.size(); ++i) {
      places[i] = best_.size();
      if (!stencil_[i]) best_.push_back(unanswered(packet_rays_[i], number(i), false, format_));
    }
    for (auto hits = pass_->next(); !hits.empty(); hits = pass_->next()) {
      for (Record r : hits) {
        r.index = slot(r.index);
        Record& best = best_[places[r.primary - first_]];
        if (better(r, best)) best = r;
      }
    }
    return best_;
  }

  // ---- Moller and watertight in fp32 ----

  [[nodiscard]] std::uint32_t number(std::size_t place) const {
    return static_cast<std::uint32_t>(first_ + place);
  }

  /// The slot of the triangle at this place of the brute-force pass.
  [[nodiscard]] std::uint32_t slot(std::uint32_t index) const {
    return secondaries_.slots.empty() ? index : secondaries_.slots[index];
  }

  /// Calls visit(place, record) for every unmasked ray of the packet that hits the triangle.
  template <typename Visit>
  void for_hits(std::uint32_t index, Visit visit) {
    const Triangle triangle = triangles_[index];
    if (!inside_(block_, triangle, mask_)) return;
    for (std::size_t i = 0; i < packet_rays_.size(); ++i) {
      if (mask_[i] == 0 || stencil_[i]) continue;
      const Record record =
          record_of(packet_rays_[i], triangle, number(i), slot(index), box_, algorithm_);
      if (record.f) visit(i, record);
    }
  }

  void stream(std::uint32_t index) {
    if (mode_ == Mode::kHits) {
      for_hits(index, [&](std::size_t, const Record& record) { records_.push_back(record); });
      return;
    }
    const Triangle triangle = triangles_[index];
    for (std::size_t i = 0; i < packet_rays_.size(); ++i) {
      if (!stencil_[i])
        records_.push_back(
            record_of(packet_rays_[i], triangle, number(i), slot(index), box_, algorithm_));
    }
  }

  /// Compares numbers, so +0 and -0 tie, as on the card. T of a hit is never NaN.
  [[nodiscard]] bool better(const Record& candidate, const Record& best) const {
    if (!best.f) return true;
    if (mode_ == Mode::kAny) return false;
    if (candidate.t == best.t) return candidate.index < best.index;
    return mode_ == Mode::kNearest ? candidate.t < best.t : candidate.t > best.t;
  }

  void reduce() {
    std::vector<Record> best(packet_rays_.size());
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i].primary = number(i);
      if (defect(packet_rays_[i])) {
        best[i].bad = true;
        best[i].t = canonical_nan<float>();
        best[i].cp.setConstant(best[i].t);
      }
    }
    for (std::size_t index = 0; index < triangles_.size(); ++index) {
      for_hits(static_cast<std::uint32_t>(index), [&](std::size_t i, const Record& record) {
        if (better(record, best[i])) best[i] = record;
      });
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (!stencil_[i]) records_.push_back(best[i]);
    }
  }

  RayBlock block_;  // first, because it is aligned for vectors
  std::size_t packet_, first_ = 0, triangle_ = 0;
  RayView rays_;
  std::vector<Ray> packet_rays_;
  TriangleView triangles_;
  std::vector<Record> records_;
  Stencil stencil_;
  PassSecondaries<Triangle> secondaries_;  // of the objects; empty without objects
  Mode mode_;
  bool box_;
  FpFormat format_;
  Algorithm algorithm_;
  InsideTest inside_;
  bool any_;      // whether the general reference is used
  Shapes words_;  // shapes of secondaries_, if any_
  std::optional<Pass> pass_;
  std::vector<Record> best_;
  std::array<std::uint8_t, RayBlock::kRays> mask_{};
};

BruteForce::BruteForce(const RayView& rays, const TriangleView& triangles, Mode mode,
                       const Stencil& stencil, unsigned packet, std::span<const Object> objects,
                       bool box, FpFormat format, Algorithm algorithm)
    : impl_(std::make_unique<Impl>(rays, triangles, mode, stencil, packet, objects, box, format,
                                   algorithm)) {}
BruteForce::~BruteForce() = default;
std::span<const Record> BruteForce::next() {
  return impl_->next();
}

std::vector<Record> cast(const RayView& rays, const TriangleView& triangles, Mode mode,
                         const Stencil& stencil, std::span<const Object> objects, bool box,
                         FpFormat format, Algorithm algorithm) {
  BruteForce brute_force(rays, triangles, mode, stencil, card::kMostPrimaries, objects, box, format,
                         algorithm);
  std::vector<Record> records;
  for (auto some = brute_force.next(); !some.empty(); some = brute_force.next())
    records.insert(records.end(), some.begin(), some.end());
  return records;
}

// ---- Comparison ----

RecordCheck::ReportOptions ray_report(const RayView& rays, const TriangleView& triangles,
                                      std::string command) {
  const auto words_of = [](const auto& shape) {
    const auto words = to_words(shape);
    return std::vector<float>(words.begin(), words.end());
  };
  return {.noun = "ray",
          .primary =
              [rays, words_of](std::uint32_t i) {
                return i < rays.size() ? words_of(rays[i]) : std::vector<float>();
              },
          .secondary =
              [triangles, words_of](std::uint32_t i) {
                return i < triangles.size() ? words_of(triangles[i]) : std::vector<float>();
              },
          .repeat =
              [command = std::move(command)](const Difference& d) {
                std::string again = command;
                for (std::size_t k = 0; k < d.primary.size(); ++k)
                  again += fmt::format("{}{:a}", k == 0 ? " --ray=" : ",", d.primary[k]);
                return again;
              }};
}

Checker::Checker(const RayView& rays, const TriangleView& triangles, Mode mode,
                 const Stencil& stencil, unsigned packet, std::string command,
                 std::span<const Object> objects, bool box, FpFormat format, Algorithm algorithm)
    : Checker(std::make_shared<BruteForce>(rays, triangles, mode, stencil, packet, objects, box,
                                           format, algorithm),
              ray_report(rays, triangles, std::move(command))) {}

Checker::Checker(std::shared_ptr<BruteForce> brute_force, ReportOptions report)
    : RecordCheck([brute_force = std::move(brute_force)] { return brute_force->next(); },
                  std::move(report)) {}

}  // namespace cde::reference
