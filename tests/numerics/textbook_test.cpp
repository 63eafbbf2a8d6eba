// SPDX-License-Identifier: Apache-2.0
// Pairs with textbook formulas (cde/accuracy/textbook.hpp): the operators that they would need,
// compared with the pipes, as in docs/tables/accuracy.md.
#include "cde/accuracy/textbook.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "cde/oracle/families.hpp"
#include "counted.hpp"
#include "in_docs.hpp"
#include "operators.hpp"

namespace cde::testing {
namespace {

/// The largest count of each operator over all cases. A loop that ends early, or an unused root,
/// needs its hardware anyway.
template <class A, class B, class Answer>
Tally most_operators(Pair pair, Answer answer) {
  constexpr std::uint64_t kSeed = 1;
  constexpr std::size_t kCases = 3000;
  const auto shape = [](auto kind, const std::vector<double>& words) {
    using P = decltype(kind);
    std::array<Counted, P::kWords> of;
    std::ranges::transform(words, of.begin(), [](double x) { return Counted(x); });
    return from_words<P>(of);
  };
  Tally most;
  for (std::size_t i = 0; i < kCases; ++i) {
    const oracle::Case c = oracle::generate(pair, kSeed, i);
    Counted::tally = {};
    (void)answer(shape(A{}, c.a), shape(B{}, c.b));
    for (int Tally::*kind : {&Tally::add, &Tally::sub, &Tally::mul, &Tally::div, &Tally::sqrt,
                             &Tally::cmp, &Tally::minmax})
      most.*kind = std::max(most.*kind, Counted::tally.*kind);
  }
  return most;
}

std::string row(Pair pair, const char* whose, const Tally& t) {
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |", name(pair), whose, t.add + t.sub,
                     t.mul, t.div, t.sqrt, t.cmp + t.minmax,
                     t.add + t.sub + t.mul + t.div + t.sqrt + t.cmp + t.minmax);
}

TEST(Textbook, Operators_EqualTheDocs) {
  namespace book = accuracy::textbook;
  using S = Counted;
  using Triangle = BasicTriangle<S>;
  using Obb = BasicObb<S>;
  using Aabb = BasicAabb<S>;
  std::vector<std::string> rows;
  const auto add = [&](Pair pair, const Tally& textbook) {
    rows.push_back(row(pair, "card", operators(pair)));
    rows.push_back(row(pair, "textbook", textbook));
  };
  add(Pair::kObbObb, most_operators<Obb, Obb>(Pair::kObbObb, book::obb_obb<S, true>));
  add(Pair::kTriangleAabb,
      most_operators<Triangle, Aabb>(Pair::kTriangleAabb, book::triangle_box<S, Aabb, true>));
  add(Pair::kTriangleObb,
      most_operators<Triangle, Obb>(Pair::kTriangleObb, book::triangle_box<S, Obb, true>));
  add(Pair::kRayCylinder, most_operators<BasicRay<S>, BasicCylinder<S>>(
                              Pair::kRayCylinder, book::ray_cylinder<S, true>));
  add(Pair::kRaySphere,
      most_operators<BasicRay<S>, BasicSphere<S>>(Pair::kRaySphere, book::ray_sphere<S, true>));
  expect_in_docs("tables/accuracy.md", rows);
}

}  // namespace
}  // namespace cde::testing
