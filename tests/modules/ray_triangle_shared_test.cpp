// SPDX-License-Identifier: Apache-2.0
// The lane whose operations share operators: bits as the reference's, for any number of turns.
#include <gtest/gtest.h>

#include <bit>
#include <deque>

#include "RayTriangleSharedEight.h"
#include "RayTriangleSharedFour.h"
#include "RayTriangleSharedHost.h"
#include "RayTriangleSharedOne.h"
#include "RayTriangleSharedTwo.h"
#include "cde/reference/reference.hpp"
#include "clocked.hpp"
#include "hard_rays.hpp"

namespace cde::testing {
namespace {

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

struct Row {
  Record should;
  unsigned due = 0;
};

template <class Module>
class Bench {
 public:
  /// Rows in a row, with random words between them. Returns the lane's latency.
  unsigned run(const hard::TriangleScene& scene, unsigned turns, bool host, std::size_t count) {
    hard::Rays draw(scene, 3);
    unsigned latency = 0;
    std::size_t given = 0;
    for (unsigned cycle = 0; given < count || !rows_.empty(); ++cycle) {
      lane_->turn_i = static_cast<CData>(cycle % turns);
      for (unsigned w = 0; w < 8; ++w) lane_->a_i[w] = dice_.below(~0u);
      for (unsigned w = 0; w < 9; ++w) lane_->b_i[w] = dice_.below(~0u);
      lane_.settle();
      latency = lane_->latency_o;
      if (cycle % turns == 0 && given < count && cycle > 300)
        give(draw(static_cast<unsigned>(given++ % hard::Rays::kKinds)), scene,
             cycle + (host ? 0 : latency));
      lane_.settle();
      if (!rows_.empty() && rows_.front().due == cycle) take();
      lane_.clock();
    }
    EXPECT_GT(hits_, 0u);
    EXPECT_GT(misses_, 0u);
    return latency;
  }

 private:
  /// Every second ray is aimed at its triangle: its inside, an edge or a corner.
  void give(Ray ray, const hard::TriangleScene& scene, unsigned due) {
    const auto i = static_cast<std::uint32_t>(dice_.below(1u << 20) % scene.size());
    const Triangle& t = scene[i];
    const auto u = static_cast<float>(dice_.below(3)), v = static_cast<float>(dice_.below(3)),
               w = static_cast<float>(dice_.below(3));
    if (u + v + w > 0 && dice_.once_in(2))
      ray.d = (u * t.v0 + v * t.v1 + w * t.v2) / (u + v + w) - ray.o;
    const auto a = to_words(ray);
    const auto b = to_words(scene[i]);
    for (unsigned w = 0; w < 8; ++w) lane_->a_i[w] = word(a.at(w));
    for (unsigned w = 0; w < 9; ++w) lane_->b_i[w] = word(b.at(w));
    rows_.push_back({reference::record_of(ray, scene[i], 0, i, true, Algorithm::kMoller), due});
  }
  void take() {
    const Record should = rows_.front().should;
    rows_.pop_front();
    if (should.bad) return;
    ++(should.f ? hits_ : misses_);
    ASSERT_EQ(lane_->f_o & 1, should.f) << "row " << hits_ + misses_;
    ASSERT_EQ(lane_->t_o, word(should.t)) << "row " << hits_ + misses_;
    for (unsigned k = 0; k < 3; ++k) ASSERT_EQ(lane_->cp_o[k], word(should.cp[k]));
  }

  Clocked<Module> lane_;
  Dice dice_;
  std::deque<Row> rows_;
  std::size_t hits_ = 0, misses_ = 0;
};

template <class Module>
unsigned expect_reference(unsigned turns, bool host, std::size_t count) {
  unsigned latency = 0;
  for (const hard::Case& c : hard::kScenes) {
    SCOPED_TRACE(c.name);
    Bench<Module> bench;
    latency = bench.run(c.make(), turns, host, count);
  }
  return latency;
}

TEST(RayTriangleShared, Gates_EqualTheReference) {
  (void)expect_reference<RayTriangleSharedOne>(1, false, 500);
  (void)expect_reference<RayTriangleSharedTwo>(2, false, 500);
  (void)expect_reference<RayTriangleSharedFour>(4, false, 500);
  (void)expect_reference<RayTriangleSharedEight>(8, false, 500);
}

/// Host arithmetic answers at once. It reports the latency of the gates.
TEST(RayTriangleShared, HostArithmetic_EqualsTheReference) {
  EXPECT_EQ(expect_reference<RayTriangleSharedHost>(4, true, 2000),
            expect_reference<RayTriangleSharedFour>(4, false, 10));
}

}  // namespace
}  // namespace cde::testing
