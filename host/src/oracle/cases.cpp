// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/cases.hpp"

#include <cstdio>
#include <stdexcept>

namespace cde::oracle {
namespace {

const contract::PairRow& row(Pair pair) {
  return contract::kPairTable.at(static_cast<std::size_t>(pair));
}

using Words = std::vector<double>;

Words words(std::initializer_list<Vec> vectors, std::initializer_list<double> rest) {
  Words out;
  for (const Vec& v : vectors) out.insert(out.end(), v.begin(), v.end());
  out.insert(out.end(), rest);
  return out;
}

Words rounded(Words words, const Format& format) {
  for (double& x : words) x = format.round(x);
  return words;
}

struct ToWords {
  Words operator()(const Triangle& s) const { return words({s.v0, s.v1, s.v2}, {}); }
  Words operator()(const Sphere& s) const { return words({s.c}, {s.r}); }
  Words operator()(const Aabb& s) const { return words({s.min, s.max}, {}); }
  Words operator()(const Plane& s) const { return words({s.n}, {s.d}); }
  Words operator()(const Cylinder& s) const {
    return words({s.c, s.axis}, {s.half_height, s.radius});
  }
  Words operator()(const Obb& s) const {
    return words({s.c, s.half, s.rotation.row(0).transpose(), s.rotation.row(1).transpose(),
                  s.rotation.row(2).transpose()},
                 {});
  }
};

struct Move {
  const Vec& by;
  Shape operator()(const Triangle& s) const { return Triangle{s.v0 + by, s.v1 + by, s.v2 + by}; }
  Shape operator()(const Aabb& s) const { return Aabb{s.min + by, s.max + by}; }
  Shape operator()(const Plane& s) const { return Plane{s.n, s.d + s.n.dot(by), s.half_space}; }
  template <class Centered>
  Shape operator()(Centered s) const {
    s.c += by;
    return s;
  }
};

}  // namespace

const char* to_string(Pair pair) {
  return row(pair).name.data();  // a literal
}
ShapeKind primary(Pair pair) {
  return row(pair).primary;
}
ShapeKind secondary(Pair pair) {
  return row(pair).secondary;
}

std::string Case::describe() const {
  std::string out = std::string(to_string(pair)) + " seed " + std::to_string(seed) + " index " +
                    std::to_string(index) + " (" + family + "): A";
  const auto append = [&](const Words& words) {
    char text[32];
    for (const double word : words) {
      std::snprintf(text, sizeof text, " %a", word);
      out += text;
    }
  };
  append(a);
  out += " B";
  append(b);
  return out;
}

Case generate(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  return has_ray(pair) ? detail::ray_case(pair, seed, index, format)
                       : detail::convex_case(pair, seed, index, format);
}

Case hard(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  return has_ray(pair) ? detail::hard_ray_case(pair, seed, index, format)
                       : detail::hard_convex_case(pair, seed, index, format);
}

Shape moved(const Shape& shape, const Vec& by) {
  return std::visit(Move{by}, shape);
}

std::vector<double> to_words(const Shape& shape, const Format& format) {
  return rounded(std::visit(ToWords{}, shape), format);
}

std::vector<double> to_words(const Ray& ray, const Format& format) {
  return rounded(words({ray.o, ray.d}, {ray.tmin, ray.tmax}), format);
}

}  // namespace cde::oracle
