// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/reference/pairs.hpp"
#include "native.hpp"

namespace cde::python {
namespace {

constexpr std::size_t kBatch = 4096;  ///< pairs between two looks for Ctrl-C

/// Row i, or the only row.
std::span<const float> row(const Rows<const float>& rows, std::size_t i, std::size_t words) {
  const auto at = static_cast<std::int64_t>(rows.shape(0) == 1 ? 0 : i);
  return {rows.data() + at * rows.stride(0), words};
}

void fill(std::vector<float>& words, const Rows<const float>& rows, std::size_t first,
          std::size_t count, std::size_t per) {
  words.resize(count * per);
  for (std::size_t i = 0; i < count; ++i)
    std::ranges::copy(row(rows, first + i, per),
                      words.begin() + static_cast<std::ptrdiff_t>(i * per));
}

struct Outputs {
  List<float> distance;
  List<bool> contact;
  Rows<float> points, normals;
  List<bool> bad;

  void put(std::size_t i, const PairAnswer& r, bool solid, bool exchanged) const {
    distance.data()[i] = solid && r.f ? -r.t : r.t;
    contact.data()[i] = r.f;
    bad.data()[i] = r.bad;
    std::copy_n(r.cp.data(), 3, points.data() + 3 * i);
    for (std::size_t k = 0; k < 3; ++k) normals.data()[3 * i + k] = exchanged ? -r.n[k] : r.n[k];
  }
};

/// Fills the outputs for pairs of rows of `a` and `b`, in the order of the pair's shapes.
void test(const std::string& name, const Rows<const float>& a, const Rows<const float>& b,
          bool exchanged, bool half_space, const Outputs& out) {
  const Pair pair = pair_named(name).value();
  const std::size_t count = out.distance.shape(0);
  const bool solid = is_solid(pair);
  const PlaneSide side = half_space ? PlaneSide::kHalfSpace : PlaneSide::kSurface;
  bool stopped = false;
  {
    const nb::gil_scoped_release release;
    std::vector<float> words_a, words_b;
    std::vector<PairAnswer> answers;
    for (std::size_t first = 0; first < count && !stopped; first += kBatch) {
      const std::size_t some = std::min(kBatch, count - first);
      fill(words_a, a, first, some, primary_words(pair));
      fill(words_b, b, first, some, secondary_words(pair));
      answers.resize(some);
      reference::test_pairs(pair, Algorithm::kMoller, words_a, words_b, answers, side);
      for (std::size_t i = 0; i < some; ++i) out.put(first + i, answers[i], solid, exchanged);
      stopped = interrupted();
    }
  }
  if (stopped) throw nb::python_error();
}

/// The pair's name, its shapes and their words in the order of the pair, and whether the given name
/// has them exchanged.
std::tuple<std::string, std::vector<std::string>, std::vector<unsigned>, bool> parse(
    const std::string& text) {
  const PairName given = pair_in_any_order(text);
  const Shape a = primary_shape(given.pair), b = secondary_shape(given.pair);
  return {std::string(name(given.pair)),
          {std::string(name(a)), std::string(name(b))},
          {words(a), words(b)},
          given.exchanged};
}

/// Why a card would refuse a shape, or nothing.
std::string defect_of(const std::string& shape, const List<const float>& row) {
  for (unsigned s = 0; s < kShapes; ++s)
    if (name(static_cast<Shape>(s)) == shape)
      return defect(static_cast<Shape>(s), {row.data(), row.shape(0)}).value_or("");
  return "";
}

}  // namespace

void add_pairs(nb::module_& module) {
  module.def("pair_names", [] { return pair_names(); });
  module.def("parse_pair", parse);
  module.def("defect", defect_of);
  module.def(
      "test_pairs",
      [](const std::string& pair, const Rows<const float>& a, const Rows<const float>& b,
         bool exchanged, bool half_space, const List<float>& distance, const List<bool>& contact,
         const Rows<float>& points, const Rows<float>& normals, const List<bool>& bad) {
        test(pair, a, b, exchanged, half_space, {distance, contact, points, normals, bad});
      });
}

}  // namespace cde::python
