// SPDX-License-Identifier: Apache-2.0
// Small inputs that request much memory. They are counted before any allocation and refused with
// size and limit, or are never held in memory as a whole.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>

#include "../expect_error.hpp"
#include "../has.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"
#include "cde/support/error.hpp"
#include "cde/support/suggest.hpp"

namespace cde::testing {
namespace {

/// Peak memory of the process so far, in MB.
double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Expects that the peak has grown by at most `most` MB.
void expect_grown(double before, double most) {
#ifdef __SANITIZE_THREAD__
  std::printf("not looked at: ThreadSanitizer takes several times the memory (%g and %g MB)\n",
              peak_mb() - before, most);
#else
  EXPECT_LT(peak_mb() - before, most);
#endif
}

const std::string kBall =
    "[[object]]\nname = \"ball\"\nsphere = { center = [0, 0, 0], radius = 1 }\n";
std::string query(const std::string& primaries, const std::string& more = "") {
  return fmt::format(
      "[[query]]\nname = \"q\"\npair = \"ray-sphere\"\nprimaries = {}\nsecondaries = \"ball\"\n{}",
      primaries, more);
}
std::string rays(const std::string& name, unsigned count) {
  return fmt::format("[[object]]\nname = \"{}\"\nrandom_rays = {{ count = {} }}\n", name, count);
}

void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
  const double before = peak_mb();
  try {
    (void)parse_scene(text, "s.toml");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCapacity) << error.what();
    for (const std::string& part : parts) EXPECT_TRUE(has(error.what(), part));
  }
  expect_grown(before, 700);  // objects before the limit may be allocated
}

TEST(SceneMemory, LargeCamera_IsRefusedWithItsSize) {
  expect_refused(kBall +
                     "[[object]]\nname = \"eye\"\ncamera = { eye = [0, 0, 9], target = [0, 0, 0], "
                     "width = 4096, height = 4096 }\n" +
                     query("\"eye\""),
                 {"s.toml:6:", "object 'eye'", "16777216 rays need 2560 MB",
                  "limit of a scene is "
                  "2048 MB"});
}

TEST(SceneMemory, ManyObjects_AreCountedTogether) {
  std::string text = kBall, names;
  for (unsigned i = 0; i < 200; ++i) {
    text += rays(fmt::format("r{}", i), 4'000'000);
    names += fmt::format("{}\"r{}\"", i == 0 ? "" : ", ", i);
  }
  expect_refused(text + query("[" + names + "]"),
                 {"object 'r3'", "4000000 rays need 611 MB", "with earlier objects 2442 MB"});
}

TEST(SceneMemory, OtherLargeSources_AreRefusedWithTheirSize) {
  expect_refused(kBall + rays("r", 1 << 24) + query("\"r\""), {"16777216 rays"});
  expect_refused(
      kBall +
          "[[object]]\nname = \"r\"\nrandom = { shape = \"obb\", count = 16777216, min = "
          "[0, 0, 0], max = [1, 1, 1], size = [1, 2] }\n" +
          query("\"r\""),
      {"16777216 obbs need 4800 MB"});
  expect_refused(
      kBall + "[[object]]\nname = \"r\"\nmesh = \"terrain:4096,4096,1\"\n" + query("\"r\""),
      {"33554432 triangles need 5760 MB"});
}

/// Two hundred ranges of four million: 3 GB as single numbers.
/// The name of an object fills the file, and a query names no object.
TEST(SceneMemory, LongNames_TakeNoMemoryForSuggestions) {
  const std::string name(8u << 20, 'a'), typed(64, 'b');
  const std::string text = fmt::format(
      "[[object]]\nname = \"{}\"\nsphere = {{ center = [0, 0, 0], radius = 1 }}\n", name);
  const double before = peak_mb();
  expect_error(ErrorCode::kBadInput, "there is no object 'bbb",
               [&] { (void)parse_scene(text + query("\"" + typed + "\""), "s.toml"); });
  expect_grown(before, 300);
}

TEST(SuggestedWords, OnlyNearWords_AreCompared) {
  const std::string large(1u << 20, 'a');
  const double before = peak_mb();
  EXPECT_EQ(edit_distance(std::string(64, 'b'), large, 22), 22u);
  EXPECT_EQ(edit_distance(large, "", 1u << 20), 1u << 20);
  EXPECT_EQ(nearest_word(large.substr(0, 64), std::vector<std::string>{large}),
            large);  // it begins with that word
  expect_grown(before, 10);
  const std::vector<std::string> lanes = {"lines", "lanes"};
  EXPECT_EQ(edit_distance("kitten", "sitting", 9), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting", 2), 2u);
  EXPECT_EQ(edit_distance("form", "from", 9), 1u);
  EXPECT_EQ(edit_distance("ca", "abc", 9), 3u);
  EXPECT_EQ(edit_distance("", "", 1), 0u);
  EXPECT_EQ(nearest_word("lanse", lanes), "lanes");
  EXPECT_EQ(nearest_word("lasne", std::vector<std::string>{"rays"}), std::nullopt);
}

TEST(SceneMemory, Masks_AreStoredAsRanges) {
  std::string mask = "mask = [7";
  for (unsigned i = 0; i < 200; ++i) mask += ", \"10..3999998\"";
  const double before = peak_mb();
  const Scene scene = parse_scene(
      kBall +
          "[[object]]\nname = \"r\"\nrandom = { shape = \"ray\", count = 4000000, min = [0, 0, 0], "
          "max = [1, 1, 1] }\n" +
          query("\"r\"", mask + ", 8, 6]\n"),
      "s.toml");
  const SceneQuery& q = scene.queries[0];
  ASSERT_EQ(q.mask.size(), 2u);
  EXPECT_EQ(q.mask[0].first, 6u);
  EXPECT_EQ(q.mask[0].count, 3u) << "6 to 8 is one range";
  EXPECT_EQ(q.mask[1].first, 10u);
  EXPECT_EQ(count(q.mask), 3u + 3'999'989);
  EXPECT_FALSE(contains(q.mask, 5));
  EXPECT_TRUE(contains(q.mask, 8));
  EXPECT_FALSE(contains(q.mask, 9));
  EXPECT_TRUE(contains(q.mask, 3'999'998));
  EXPECT_FALSE(contains(q.mask, 3'999'999));
  EXPECT_EQ(plan(scene).queries[0].tests, 4'000'000u - count(q.mask));
  expect_grown(before, 500);
}

TEST(Pictures, LargestPicture_TakesNoMemory) {
  const Eigen::AlignedBox3f box(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(8, 4, 1));
  const double before = peak_mb();
  const Resolution largest{32768, 32768};
  const RayView grid = grid_pixels(box, largest);
  ASSERT_EQ(grid.size(), std::size_t{1} << 30);
  EXPECT_EQ(grid[0].o.x(), static_cast<float>(8 * 0.5 / 32768));
  EXPECT_EQ(grid[grid.size() - 1].o.x(), static_cast<float>(8 * 32767.5 / 32768));
  const Camera camera = camera_for(box, largest);
  const RayView seen = camera.pixels(largest);
  EXPECT_EQ(seen[0].o, camera.eye);
  EXPECT_LT(seen[seen.size() - 1].d.z(), seen[0].d.z()) << "the last row is the lowest";
  expect_grown(before, 50);
}

TEST(Pictures, RayView_EqualsTheRays) {
  const Camera camera{{3, -4, 5}, {0, 1, 0}};
  const Resolution size{37, 23};
  const std::vector<Ray> all = camera.rays(size);
  const RayView given(all), made(camera.pixels(size));
  ASSERT_EQ(made.size(), all.size());
  for (const RayView& view : {given, made}) {
    const RayView part = view.subview(100, 300).subview(50, 1000);
    ASSERT_EQ(part.size(), 250u);
    const std::vector<Ray> copy = part.copy();
    for (std::size_t i = 0; i < part.size(); ++i) {
      EXPECT_EQ(part[i].o, all[150 + i].o);
      EXPECT_EQ(part[i].d, all[150 + i].d);
      EXPECT_EQ(copy[i].d, all[150 + i].d);
    }
  }
  EXPECT_TRUE(RayView().empty());
}

}  // namespace
}  // namespace cde::testing
