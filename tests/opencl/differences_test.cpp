// SPDX-License-Identifier: Apache-2.0
// The comparison of a baseline's hits with records: every kind of difference is noticed.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "baselines/hit_differences.hpp"
#include "cde/reference/reference.hpp"
#include "expect_error.hpp"
#include "hard_rays.hpp"

namespace cde::testing {
namespace {

using baseline::ClosestHit;
using baseline::HitDifferences;

class Differences : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto scene = hard::icosphere({0, 0, 0});
    hard::Rays draw(scene, 5);
    std::vector<Ray> rays;
    for (unsigned i = 0; i < 200; ++i) rays.push_back(draw(i % hard::Rays::kKinds));
    records_ = reference::cast(rays, scene, Mode::kNearest, {}, {}, true);
    for (const Record& r : records_) hits_.push_back({r.t, r.index});
    hit_ = static_cast<std::size_t>(
        std::find_if(records_.begin(), records_.end(), [](const Record& r) { return r.f; }) -
        records_.begin());
    miss_ = static_cast<std::size_t>(
        std::find_if(records_.begin(), records_.end(), [](const Record& r) { return !r.f; }) -
        records_.begin());
    ASSERT_LT(hit_, records_.size());
    ASSERT_LT(miss_, records_.size());
  }
  [[nodiscard]] HitDifferences found() const { return baseline::compare_hits(records_, hits_); }

  std::vector<Record> records_;
  std::vector<ClosestHit> hits_;
  std::size_t hit_ = 0, miss_ = 0;
};

TEST_F(Differences, EqualHits_HaveNone) {
  EXPECT_EQ(found().equal(), 200u);
  EXPECT_EQ(found().text(), "all equal");
  baseline::require_few(found(), "it");
}

TEST_F(Differences, HitThatWasAMiss_IsNoticed) {
  hits_[miss_] = {1, 3};
  EXPECT_EQ(found().extra_hits, 1u);
  EXPECT_EQ(found().text(), "1 extra hits");
}

TEST_F(Differences, MissThatWasAHit_IsNoticed) {
  hits_[hit_] = {};
  EXPECT_EQ(found().missed_hits, 1u);
}

TEST_F(Differences, OtherT_IsNoticed) {
  hits_[hit_].t *= 1.001f;
  EXPECT_EQ(found().other_t, 1u);
  hits_[hit_].t = std::nanf("");
  EXPECT_EQ(found().other_t, 1u);
}

TEST_F(Differences, LastBitOfT_IsNoticedButNotWrong) {
  hits_[hit_].t = std::nextafter(hits_[hit_].t, 1e9f);
  EXPECT_EQ(found().rounded_t, 1u);
  EXPECT_EQ(found().wrong(), 0u);
}

TEST_F(Differences, OtherTriangle_IsNoticedButNotWrong) {
  ++hits_[hit_].index;
  EXPECT_EQ(found().other_triangles, 1u);
  EXPECT_EQ(found().equal(), 199u);
  EXPECT_EQ(found().wrong(), 0u);
}

TEST_F(Differences, MoreThanOneIn50_IsAnError) {
  std::size_t changed = 0;
  for (std::size_t i = 0; i < hits_.size() && changed < 5; ++i)
    if (records_[i].f) hits_[i] = {}, ++changed;
  expect_error(ErrorCode::kMismatch, "PoCL: of 200 rays 5 differ from the reference: 5 missed hits",
               [&] { baseline::require_few(found(), "PoCL"); });
  hits_[hit_] = {records_[hit_].t, records_[hit_].index};
  baseline::require_few(found(), "PoCL");  // four are one in 50
}

TEST_F(Differences, MissingHits_AreAnError) {
  hits_.pop_back();
  expect_error(ErrorCode::kMismatch, "199 hits for 200 records", [&] { (void)found(); });
}

}  // namespace
}  // namespace cde::testing
