// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_runner_faults.hpp"

#include <fmt/format.h>

#include <bit>
#include <set>

#include "cde/geometry/motion.hpp"
#include "cde/support/error.hpp"

namespace cde::scene_runner {

void Faults::start(std::uint32_t frame) {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (done_[i] || all_[i].frame != frame || !all_[i].bus) continue;
    board_->inject(*all_[i].bus, all_[i].count, all_[i].value);
    done_[i] = true;
  }
}

void Faults::flip(std::uint32_t frame, std::uint64_t words) {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (done_[i] || all_[i].frame != frame || all_[i].bus) continue;
    flip(all_[i], i, words);
    done_[i] = true;
  }
}

void Faults::flip(const ScheduledFault& fault, std::uint64_t stream, std::uint64_t words) {
  if (fault.count > words)
    throw Error(ErrorCode::kUsage,
                fmt::format("fault '{}': the secondaries have {} words", text_of(fault), words));
  std::set<std::uint64_t> chosen;
  for (std::uint64_t n = 0; chosen.size() < fault.count; ++n)
    chosen.insert(random_bits(fault.frame, 2 * stream, n) % words);
  for (const std::uint64_t word : chosen) {
    std::uint32_t bits = 0;
    for (std::uint64_t n = 0; std::popcount(bits) < static_cast<int>(fault.value); ++n)
      bits |= 1u << random_bits(fault.frame + word, 2 * stream + 1, n) % 32;
    for (unsigned byte = 0; byte < 4; ++byte) {
      const auto mask = static_cast<std::uint8_t>(bits >> (8 * byte));
      if (mask != 0) board_->flip_ddr(4 * word + byte, mask);
    }
  }
}

}  // namespace cde::scene_runner
