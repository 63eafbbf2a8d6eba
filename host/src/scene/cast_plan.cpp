// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/cast_plan.hpp"

#include <fmt/format.h>

#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "scene/bvh_choice.hpp"
#include "scene/plan_card.hpp"

namespace cde {
namespace {

/// Estimated microseconds of simulation. Building a BVH takes 1 us per triangle, and traversing it
/// 4 us per ray. Brute force on 16 lanes takes 13 ns per test (cde bench).
bvh_choice::Cost cost(std::uint64_t triangles, std::uint64_t rays) {
  const auto t = static_cast<double>(triangles), r = static_cast<double>(rays);
  return {t + 4 * r, 13e-3 * t * r};
}

/// The same per ray, once the BVH is built: overlapping boxes cull little. Simulating a cycle takes
/// 0.4 us.
bvh_choice::Cost cost(const CastRequest& r, const Bvh& bvh, std::uint64_t triangles) {
  const Bvh::Visits visits = bvh.expected_visits();
  return {2 + 0.4 * bvh_choice::cycles(r.device, visits.nodes, visits.secondaries),
          13e-3 * static_cast<double>(triangles)};
}

bool must_traverse(const CastRequest& r) {
  return r.bvh.value_or(false) || r.mode == Mode::kOccluded;
}

bool traverses(const CastRequest& r, std::uint64_t triangles,
               const std::optional<bvh_choice::Cost>& cost = {}) {
  return bvh_choice::traverses(must_traverse(r), Shape::kTriangle, triangles, cost);
}

/// The lanes of the device. Gates take minutes to compile, so they get fewer.
unsigned lanes_of(const CastRequest& r) {
  if (r.lanes) return *r.lanes;
  return r.arithmetic == Arithmetic::kHost ? r.device.lanes
                                           : std::min(plan_card::kMostLanesOfGates, r.device.lanes);
}

/// The BVH, or nothing where brute force is as good. `warning` says why a BVH cannot be built.
std::shared_ptr<const Bvh> built_bvh(const CastRequest& r, const Mesh& mesh, std::string& warning) {
  std::shared_ptr<const Bvh> bvh;
  try {
    bvh = std::make_shared<const Bvh>(Bvh::build(mesh));
  } catch (const Error& e) {
    if (must_traverse(r)) throw;
    warning = e.what();
    return nullptr;
  }
  const std::uint64_t triangles = mesh.faces.size();
  return traverses(r, triangles, cost(r, *bvh, triangles)) ? bvh : nullptr;
}

/// Replaces a card that is not built by a built one, if this adds at most 0.3 minutes or so of
/// simulation.
void use_built_card(const CastRequest& r, CastPlan& plan, std::uint64_t rays,
                    std::uint64_t triangles) {
  constexpr double kMostTests = 1e10;
  if (r.exact_card || static_cast<double>(rays) * static_cast<double>(triangles) > kMostTests)
    return;
  SceneCard asked;
  asked.device = r.device;
  if (r.lanes) asked.lanes = plan.card.lanes;
  const auto card = built_card(plan.card, asked, [&](unsigned lanes) {
    return ((rays / card::kMostPrimaries) * (card::kMostPrimaries / lanes) +
            (rays % card::kMostPrimaries + lanes - 1) / lanes) *
           triangles;
  });
  if (!card) return;
  plan.stands_in_for = {plan.card, card->times};
  plan.card = card->board;
}

}  // namespace

std::optional<std::string> why_not_traversable(const CastRequest& r) {
  if (r.mode == Mode::kAll) return "mode all reports every triangle, hit or not";
  if (!r.box) return "without the box rule a BVH would not give the same records";
  if (r.format != FpFormat{})
    return fmt::format(
        "a BVH widens boxes by 2^-16 of the scene, and {} would widen them by percents",
        r.format.name());
  if (r.parts) return "parts of a mesh use brute force";
  return std::nullopt;
}

bool may_traverse(const CastRequest& r, std::uint64_t triangles) {
  const auto why_not = why_not_traversable(r);
  if (r.mode == Mode::kOccluded && (why_not || !r.bvh.value_or(true)))
    throw Error(ErrorCode::kUsage, "mode occluded needs a BVH: " +
                                       why_not.value_or("it cannot be combined with --no-bvh"));
  if (r.bvh.value_or(false) && why_not) throw Error(ErrorCode::kUsage, "--bvh: " + *why_not);
  return !why_not && (must_traverse(r) || (!r.bvh && !r.lanes)) && traverses(r, triangles);
}

CastPlan plan_cast(const CastRequest& r, const Mesh& mesh, std::uint64_t rays) {
  const std::uint64_t triangles = mesh.faces.size();
  CastPlan plan;
  plan.card.arithmetic = r.arithmetic;
  plan.card.algorithm = r.algorithm;
  plan.card.box = r.box;
  plan.card.format = r.format;
  plan.card.trace = r.trace;
  plan.card.lanes = lanes_of(r);
  plan.card = on(r.device, plan.card);
  if (may_traverse(r, triangles) && traverses(r, triangles, cost(triangles, rays)))
    plan.bvh = built_bvh(r, mesh, plan.warning);
  if (plan.bvh) {
    add_traversal_units(r.device, bvh_choice::node_memory(*plan.bvh, triangles), plan.card);
    if (!r.lanes) plan.card.lanes = r.device.leaf_lanes();
  }
  if (!plan.bvh) use_built_card(r, plan, rays, triangles);
  return plan;
}

}  // namespace cde
