// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "cde/reference/pipes/transform.hpp"
#include "scene/parts.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

constexpr std::array kCheckNames = {"all", "sample", "none"};

Transform rounded(const Pose& pose) {
  return {pose.linear().cast<float>(), pose.translation().cast<float>()};
}

Pose chained(const Scene& scene, const SceneObject& object, double time) {
  std::vector<const SceneObject*> chain = {&object};
  while (chain.back()->parent) chain.push_back(&scene.objects[*chain.back()->parent]);
  Pose sum = pose(chain.back()->motion, time);
  for (chain.pop_back(); !chain.empty(); chain.pop_back())
    sum = sum * pose(chain.back()->motion, time);
  return sum;
}

Eigen::Vector3d displacement(const Deformation& d, const Eigen::Vector3d& at, std::uint32_t vertex,
                             std::uint32_t frame, double time) {
  if (d.kind == Deformation::Kind::kWave) {
    const double phase = time / d.period - d.direction.dot(at) / d.wavelength;
    return d.amplitude * std::sin(2 * std::numbers::pi * phase);
  }
  Eigen::Vector3d u;
  for (int k = 0; k < 3; ++k)
    u[k] =
        2 * random_unit(d.seed, frame, 3 * std::uint64_t{vertex} + static_cast<std::uint64_t>(k)) -
        1;
  return d.amplitude.cwiseProduct(u);
}

std::vector<Triangle> deformed(const Mesh& mesh, const Deformation& d, std::vector<Triangle> shapes,
                               const std::vector<Range>& ranges, std::uint32_t frame, double time) {
  std::vector<Eigen::Vector3f> moved(mesh.vertices.begin() + d.first,
                                     mesh.vertices.begin() + d.last + 1);
  for (std::uint32_t v = d.first; v <= d.last; ++v) {
    const Eigen::Vector3d at = mesh.vertices[v].cast<double>();
    moved[v - d.first] = (at + displacement(d, at, v, frame, time)).cast<float>();
  }
  const auto corner = [&](std::uint32_t v) {
    return v < d.first || v > d.last ? mesh.vertices[v] : moved[v - d.first];
  };
  for (const Range& range : ranges) {
    for (std::size_t i = range.first; i < range.first + range.count; ++i) {
      const auto& face = mesh.faces[i];
      shapes[i] = {corner(face[0]), corner(face[1]), corner(face[2])};
    }
  }
  return shapes;
}

/// Equals Eigen::Quaterniond::FromTwoVectors(UnitZ(), axis), bit for bit unless they are nearly
/// opposite. Eigen's singular value decomposition for that case takes very long to compile.
Eigen::Quaterniond from_z(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), to = axis.normalized();
  const Eigen::Vector3d normal = z.cross(to);
  const double cosine = std::max(to.dot(z), -1.0);
  Eigen::Quaterniond turn;
  if (cosine < -1 + Eigen::NumTraits<double>::dummy_precision()) {
    const double w2 = (1 + cosine) * 0.5;
    turn.w() = std::sqrt(w2);
    turn.vec() = (normal.isZero(0) ? Eigen::Vector3d(-1, 0, 0) : normal.normalized().eval()) *
                 std::sqrt(1 - w2);
    return turn;
  }
  const double s = std::sqrt((1 + cosine) * 2);
  turn.vec() = normal * (1 / s);
  turn.w() = s * 0.5;
  return turn;
}

std::vector<Ray> drawn(const RandomRays& rays, std::uint32_t frame) {
  const Eigen::Quaterniond turn = from_z(rays.axis);
  const double lowest = std::cos(rays.half_angle);
  std::vector<Ray> drawn;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    const double z = 1 - random_unit(rays.seed, 2 * std::uint64_t{frame}, i) * (1 - lowest);
    const double around =
        2 * std::numbers::pi * random_unit(rays.seed, 2 * std::uint64_t{frame} + 1, i);
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const Eigen::Vector3d d = turn * Eigen::Vector3d(r * std::cos(around), r * std::sin(around), z);
    drawn.push_back({Eigen::Vector3f::Zero(), d.cast<float>()});
  }
  return drawn;
}

bool is_identity(const Transform& t) {
  return t.rotation == Eigen::Matrix3f::Identity() && t.translation.isZero(0);
}

template <class Pick>
Shapes posed_each(const Shapes& shapes, Pick pick) {
  return std::visit(
      [&](auto list) -> Shapes {
        for (std::size_t i = 0; i < list.size(); ++i) {
          // An unmoved shape keeps all its bits, including signs of zeros.
          const Transform& t = pick(i);
          if (!is_identity(t)) list[i] = reference::transformed(t, list[i]);
        }
        return list;
      },
      shapes);
}

}  // namespace

bool contains(const std::vector<Range>& ranges, std::size_t number) {
  const auto behind =
      std::upper_bound(ranges.begin(), ranges.end(), number,
                       [](std::size_t n, const Range& range) { return n < range.first; });
  return behind != ranges.begin() && number - std::prev(behind)->first < std::prev(behind)->count;
}

std::size_t count(const std::vector<Range>& ranges) {
  std::size_t sum = 0;
  for (const Range& range : ranges) sum += range.count;
  return sum;
}

std::vector<Eigen::Vector3d> scene_parts::centres(const Shapes& shapes) {
  return std::visit(
      [](const auto& list) {
        std::vector<Eigen::Vector3d> centres;
        centres.reserve(list.size());
        for (const auto& shape : list) centres.push_back(primitive_cast<double>(shape).middle());
        return centres;
      },
      shapes);
}

const char* name_of(Check check) {
  return text::entry(kCheckNames, check, "way to check");
}

std::optional<Check> check_named(std::string_view text) {
  const auto* found = std::find(kCheckNames.begin(), kCheckNames.end(), text);
  if (found == kCheckNames.end()) return std::nullopt;
  return static_cast<Check>(found - kCheckNames.begin());
}

Transform pose(const Scene& scene, const SceneObject& object, std::uint32_t frame) {
  return rounded(chained(scene, object, seconds(scene, frame)));
}

Shapes local_shapes(const Scene& scene, const SceneObject& object, std::uint32_t frame) {
  if (object.rays) return drawn(*object.rays, object.rays->redraw ? frame : 0);
  if (object.deform)
    return deformed(*object.mesh, *object.deform, std::get<std::vector<Triangle>>(object.shapes),
                    deforming(object), frame, seconds(scene, frame));
  return object.shapes;
}

std::vector<Range> deforming(const SceneObject& object) {
  if (object.rays && object.rays->redraw) return {{0, size(object.shapes)}};
  if (!object.deform) return {};
  // Nearer ranges are cheaper to write as one.
  constexpr std::size_t kGap = 4;
  const Deformation& d = *object.deform;
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < object.mesh->faces.size(); ++i) {
    const auto& face = object.mesh->faces[i];
    if (std::none_of(face.begin(), face.end(),
                     [&](std::uint32_t v) { return v >= d.first && v <= d.last; }))
      continue;
    if (!ranges.empty() && i - (ranges.back().first + ranges.back().count) <= kGap)
      ranges.back().count = i + 1 - ranges.back().first;
    else
      ranges.push_back({i, 1});
  }
  return ranges;
}

bool has_member_poses(const SceneObject& object) {
  const auto* random = std::get_if<RandomMotion>(&object.motion);
  return random != nullptr && random->each;
}

std::vector<Transform> member_poses(const Scene& scene, const SceneObject& object,
                                    std::uint32_t frame) {
  const auto& motion = std::get<RandomMotion>(object.motion);
  const double time = seconds(scene, frame);
  const Pose above =
      object.parent ? chained(scene, scene.objects[*object.parent], time) : Pose::Identity();
  std::vector<Transform> poses;
  for (const Eigen::Vector3d& centre : scene_parts::centres(object.shapes))
    poses.push_back(rounded(above * member_pose(motion, centre, poses.size(), time)));
  return poses;
}

bool is_still(const Scene& scene, const SceneObject& object) {
  const SceneObject* at = &object;
  while (!moves(at->motion) && at->parent) at = &scene.objects[*at->parent];
  return !moves(at->motion);
}

Shapes posed(const Shapes& shapes, const Transform& pose) {
  return posed_each(shapes, [&](std::size_t) -> const Transform& { return pose; });
}

Shapes posed(const Shapes& shapes, const std::vector<Transform>& poses) {
  return posed_each(shapes, [&](std::size_t i) -> const Transform& { return poses[i]; });
}

}  // namespace cde
