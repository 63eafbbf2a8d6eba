// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "cast/job.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/reference.hpp"
#include "cde/reference/traversal.hpp"

namespace cde::cli {

/// Compares the records of a cast with the reference of its card: brute force, or the traversal of
/// its BVH. With a BVH, some rays are also compared with brute force.
class CastCheck {
 public:
  /// All arguments must outlive the check.
  CastCheck(const CastTask& task, const CastJob& job, Mode mode, const RayView& rays,
            const Board& board);

  void compare(std::span<const Record> records) { check_.compare(records); }
  void end();
  void report(CastOutcome& to) const;

 private:
  [[nodiscard]] std::span<const Record> next();
  [[nodiscard]] std::vector<Record> traversed(std::size_t ray);
  void traverse_packet(std::size_t first, std::size_t count);
  void brute_force_packet();
  [[nodiscard]] bool as_all_triangles(std::span<const Record> some, std::span<const Record> all);

  const CastJob& job_;
  Mode mode_;
  RayView rays_;
  unsigned packet_;
  std::optional<reference::BruteForce> brute_force_;  ///< empty with a BVH
  std::optional<reference::Traversal> traversal_;
  std::vector<Record> traversed_;
  std::uint64_t brute_force_rays_ = 0, brute_force_done_ = 0;
  std::size_t first_ = 0;  ///< first ray of the next packet
  reference::RecordCheck check_;
};

}  // namespace cde::cli
