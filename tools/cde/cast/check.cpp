// SPDX-License-Identifier: Apache-2.0
#include "cast/check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cde/contract/records.hpp"
#include "cde/support/shell_word.hpp"

namespace cde::cli {
namespace {

/// The begin of a command that repeats the cast with other rays.
std::string command_of(const CastTask& o, const CastJob& job, Mode mode) {
  const CastRequest& r = o.request;
  std::string text = fmt::format("cde cast {} --mode {} --lanes {} --arith {}", shell_word(o.mesh),
                                 cde::name_of(mode), job.config.lanes, name_of(r.arithmetic));
  if (!r.box) text += " --no-box";
  if (r.format != FpFormat{}) text += " --format " + r.format.name();
  if (r.algorithm != kLeakFree) text += fmt::format(" --algorithm {}", name(r.algorithm));
  if (job.bvh)
    text += " --bvh";
  else if (!r.bvh.value_or(true))
    text += " --no-bvh";
  return text;
}

}  // namespace

CastCheck::CastCheck(const CastTask& o, const CastJob& job, Mode mode, const RayView& rays,
                     const Board& board)
    : job_(job),
      mode_(mode),
      rays_(rays),
      packet_(board.primaries()),
      check_([this] { return next(); },
             reference::ray_report(rays, job.mesh, command_of(o, job, mode))) {
  brute_force_rays_ = std::min<std::uint64_t>(o.brute_force_rays, rays.size());
  check_.set_place([&board, this](std::uint32_t ray) {
    return traversal_ ? fmt::format("cycle {} (record read)", board.cycles())
                      : place_on_card(board, ray % packet_);
  });
  if (job.bvh) {
    traversal_.emplace(job.mesh, *job.bvh, job.config.algorithm);
  } else {
    brute_force_.emplace(rays, job.mesh, mode, Stencil(), packet_, std::span<const Object>(),
                         o.request.box, job.config.format, job.config.algorithm);
  }
}

void CastCheck::end() {
  check_.compare_end();
  if (!traversal_) return;
  while (brute_force_done_ < brute_force_rays_ && check_.difference().empty()) brute_force_packet();
}

void CastCheck::report(CastOutcome& to) const {
  to.brute_force_rays = brute_force_done_;
  to.compared = check_.compared();
  to.matching = check_.matching();
  to.difference = check_.difference();
  to.first_difference = check_.first_difference();
}

/// The next records of the reference; empty at the end.
std::span<const Record> CastCheck::next() {
  if (brute_force_) return brute_force_->next();
  while (first_ < rays_.size()) {
    const std::size_t first = first_, count = std::min<std::size_t>(packet_, rays_.size() - first);
    first_ += count;
    traverse_packet(first, count);
    if (!traversed_.empty()) return traversed_;
  }
  return {};
}

std::vector<Record> CastCheck::traversed(std::size_t ray) {
  const auto number = static_cast<std::uint32_t>(ray);
  const bool f_alone = mode_ == Mode::kOccluded;
  std::vector<Record> some = traversal_->trace(rays_[ray], number, f_alone ? Mode::kAny : mode_);
  if (f_alone)
    for (Record& r : some) {
      Record plain;
      plain.f = r.f, plain.bad = r.bad, plain.primary = r.primary;
      if (r.bad) plain.t = r.t, plain.cp = r.cp;
      r = plain;
    }
  return some;
}

/// Traverses the BVH in the reference, in the order of the card.
void CastCheck::traverse_packet(std::size_t first, std::size_t count) {
  traversed_.clear();
  for (std::size_t i = first; i < first + count; ++i)
    for (const Record& r : traversed(i)) traversed_.push_back(r);
  if (mode_ == Mode::kHits)
    std::sort(traversed_.begin(), traversed_.end(), [](const Record& a, const Record& b) {
      return a.index != b.index ? a.index < b.index : a.primary < b.primary;
    });
}

/// Compares evenly spread rays with brute force, all in one pass over the triangles, which is much
/// faster than ray by ray.
void CastCheck::brute_force_packet() {
  const std::uint64_t count =
      std::min<std::uint64_t>(card::kMostPrimaries, brute_force_rays_ - brute_force_done_);
  std::vector<Ray> rays;
  std::vector<std::size_t> numbers;
  for (std::uint64_t k = brute_force_done_; k < brute_force_done_ + count; ++k) {
    numbers.push_back(static_cast<std::size_t>(k * rays_.size() / brute_force_rays_));
    rays.push_back(rays_[numbers.back()]);
  }
  const Mode mode = mode_ == Mode::kOccluded ? Mode::kAny : mode_;
  std::vector<std::vector<Record>> all(count);
  for (Record r : reference::cast(rays, job_.mesh, mode, {}, {}, true, {}, job_.config.algorithm)) {
    std::vector<Record>& of_ray = all[r.primary];
    r.primary = static_cast<std::uint32_t>(numbers[r.primary]);
    of_ray.push_back(r);
  }
  for (std::uint64_t k = 0; k < count; ++k, ++brute_force_done_)
    if (!as_all_triangles(traversed(numbers[k]), all[k])) return;
}

bool CastCheck::as_all_triangles(std::span<const Record> some, std::span<const Record> all) {
  const auto same = [&](const Record& a, const Record& b) {
    return mode_ == Mode::kOccluded ? a.f == b.f : same_bits(a, b);
  };
  for (std::size_t r = 0; r < std::max(all.size(), some.size()); ++r) {
    if (r < all.size() && r < some.size() && same(some[r], all[r])) continue;
    check_.differ(r < some.size() ? &some[r] : nullptr, r < all.size() ? &all[r] : nullptr);
    return false;
  }
  return true;
}

}  // namespace cde::cli
