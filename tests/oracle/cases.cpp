#include "cases.hpp"

#include <cstdio>
#include <stdexcept>

namespace cde::oracle {
namespace {

struct PairEntry {
  const char* name;
  ShapeKind a, b;
};

const PairEntry& entry(Pair pair) {
  using enum ShapeKind;
  static constexpr std::array<PairEntry, 13> kEntries = {
      {{"ray-triangle", kRay, kTriangle},
       {"obb-obb", kObb, kObb},
       {"triangle-aabb", kTriangle, kAabb},
       {"triangle-obb", kTriangle, kObb},
       {"sphere-sphere", kSphere, kSphere},
       {"triangle-sphere", kTriangle, kSphere},
       {"ray-cylinder", kRay, kCylinder},
       {"triangle-cylinder", kTriangle, kCylinder},
       {"cylinder-cylinder", kCylinder, kCylinder},
       {"obb-cylinder", kObb, kCylinder},
       {"obb-plane", kObb, kPlane},
       {"ray-sphere", kRay, kSphere},
       {"sphere-obb", kSphere, kObb}}};
  return kEntries.at(static_cast<std::size_t>(pair));
}

std::vector<float> words(std::initializer_list<Vec> vectors, std::initializer_list<double> rest) {
  std::vector<float> out;
  for (const Vec& v : vectors)
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(v[k]));
  for (double x : rest) out.push_back(static_cast<float>(x));
  return out;
}

struct ToWords {
  std::vector<float> operator()(const Triangle& s) const { return words({s.v0, s.v1, s.v2}, {}); }
  std::vector<float> operator()(const Sphere& s) const { return words({s.c}, {s.r}); }
  std::vector<float> operator()(const Aabb& s) const { return words({s.min, s.max}, {}); }
  std::vector<float> operator()(const Plane& s) const { return words({s.n}, {s.d}); }
  std::vector<float> operator()(const Cylinder& s) const {
    return words({s.c, s.axis}, {s.half_height, s.radius});
  }
  std::vector<float> operator()(const Obb& s) const {
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
  return entry(pair).name;
}
ShapeKind primary(Pair pair) {
  return entry(pair).a;
}
ShapeKind secondary(Pair pair) {
  return entry(pair).b;
}

std::string Case::describe() const {
  std::string out = std::string(to_string(pair)) + " seed " + std::to_string(seed) + " index " +
                    std::to_string(index) + " (" + family + "): A";
  const auto append = [&](const std::vector<float>& words) {
    char text[32];
    for (float word : words) {
      std::snprintf(text, sizeof text, " %a", static_cast<double>(word));
      out += text;
    }
  };
  append(a);
  out += " B";
  append(b);
  return out;
}

Case generate(Pair pair, std::uint64_t seed, std::uint64_t index) {
  return has_ray(pair) ? detail::ray_case(pair, seed, index)
                       : detail::convex_case(pair, seed, index);
}

Shape moved(const Shape& shape, const Vec& by) {
  return std::visit(Move{by}, shape);
}

std::vector<float> to_words(const Shape& shape) {
  return std::visit(ToWords{}, shape);
}

std::vector<float> to_words(const Ray& ray) {
  return words({ray.o, ray.d}, {ray.tmin, ray.tmax});
}

}  // namespace cde::oracle
