// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cast/job.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/contract/records.hpp"
#include "cde/jobs/work_distributor.hpp"
#include "cde/support/counted.hpp"
#include "output/device_output.hpp"
#include "output/plan_output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

/// Cards that share the work: in this process, in the ranks, or one per part of the mesh.
unsigned cards_of(const CastTask& o) {
  return o.partition > 1 ? o.partition : std::max(o.boards, WorkDistributor::instance().ranks());
}

/// Whether modelled times include a network between several cards.
bool has_network(const CastTask& o) {
  return std::max(o.partition, WorkDistributor::instance().ranks()) > 1;
}

std::size_t packets_of(const CastJob& job) {
  return (job.rays.size() + card::kMostPrimaries - 1) / card::kMostPrimaries;
}

}  // namespace

nlohmann::ordered_json summary_json(const CastTask& o, const CastJob& job, const CastOutcome& r) {
  nlohmann::ordered_json j = program_json();
  j.update({{"mesh", o.mesh},
            {"triangles", job.triangles},
            {"rays", job.rays.size()},
            {"packets", packets_of(job)},
            {"mode", cde::name_of(o.request.mode)},
            {"boards", cards_of(o)},
            {"partition", o.partition},
            {"network", has_network(o) ? nlohmann::ordered_json(kNetwork) : nullptr}});
  j.update(card_json(job.config));
  j.update(model_json(r.model, r.config_hash));
  j.update(stand_in_json(job.stands_in_for));
  j.update({{"device", device_json(device_for(o.request.device, job.config))},
            {"clock_hz", o.request.device.clock_hz()},
            {"modelled_pass_seconds", r.modelled_seconds}});
  j.update(counters_json(r.counters));
  j.update(
      {{"secondary_upload_cycles", r.upload_cycles},
       {"primary_upload_cycles", r.counters.upload_cycles},
       {"total_cycles", r.counters.total_cycles},
       {"simulation_seconds", r.simulation_seconds},
       {"tests_per_second_simulated", static_cast<double>(r.counters.pairs) / r.simulation_seconds},
       {"hits", r.hits},
       {"records", r.counters.records},
       {"records_compared", r.compared},
       {"records_matching", r.matching},
       {"mismatches", r.compared - r.matching},
       {"through", job.bvh ? "bvh" : "brute_force"},
       {"brute_force_rays", r.brute_force_rays},
       {"checked", o.check}});
  return j;
}

namespace {

std::string text_of(const Eigen::Vector3f& v) {
  return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z());
}
std::string text_of(const Eigen::AlignedBox3f& box) {
  return fmt::format("{} to {}", text_of(box.min()), text_of(box.max()));
}

}  // namespace

void warn_of_misses(const CastTask& o, const CastJob& job, const CastOutcome& r) {
  if (r.hits != 0 || job.rays.empty()) return;
  Eigen::AlignedBox3f origins;
  for (std::size_t i = 0; i < job.rays.size(); ++i) origins.extend(job.rays[i].o);
  const Ray first = job.rays[0];
  warn({fmt::format(
      "no ray hit {}, which reaches from {}; rays start {} {}, the first with the "
      "direction {}",
      printable_name(o.mesh), text_of(job.bounds), origins.min() == origins.max() ? "at" : "from",
      origins.min() == origins.max() ? text_of(first.o) : text_of(origins), text_of(first.d))});
}

void print_summary(const CastTask& o, const CastJob& job, const CastOutcome& r) {
  const Counters& c = r.counters;
  // Includes shadow rays.
  const std::uint64_t rays = job.mode == Mode::kHits ? job.rays.size() : c.records;
  const auto row = [](const char* name, const std::string& value) {
    log("{:<16} {}\n", name, value);
  };
  row("mesh", fmt::format("{}, {}", printable_name(o.mesh), counted(job.triangles, "triangle")));
  row("bounds", text_of(job.bounds));
  row("rays", fmt::format("{} in {}", job.rays.size(), counted(packets_of(job), "packet")));
  const unsigned cards = cards_of(o);
  row(cards == 1 ? "card" : "cards",
      fmt::format("{}{}, {} arithmetic, {}, {}, {}, mode {}",
                  cards == 1 ? "" : fmt::format("{} x ", cards), counted(job.config.lanes, "lane"),
                  name_of(o.request.arithmetic), job.config.format.name(),
                  name(o.request.algorithm), o.request.box ? "box rule" : "no box rule",
                  cde::name_of(o.request.mode)));
  if (job.bvh) {
    const auto a_ray = [&](std::uint64_t n) {
      return static_cast<double>(n) / static_cast<double>(rays);
    };
    row("BVH", fmt::format(
                   "{}, {}, {}; per ray {:.1f} nodes read{}, {:.1f} triangles tested",
                   counted(job.bvh->nodes().size(), "node"), counted(job.bvh->depth(), "level"),
                   counted(job.config.traversal_units, "traversal unit"), a_ray(c.nodes),
                   c.cached_nodes == 0 ? ""
                                       : fmt::format(" ({:.2f} not on chip, {:.2f} fetched)",
                                                     a_ray(c.cached_nodes), a_ray(c.fetched_nodes)),
                   a_ray(c.pairs)));
  }
  row("device", device_row(device_for(o.request.device, job.config)));
  row("device cycles", fmt::format("{}, {} for write-back; {}, {}", c.cycles, c.writeback,
                                   counted(c.stalls, "stall"), counted(c.bubbles, "idle cycle")));
  row("modelled time",
      fmt::format("{:.6g} ms on {}, memory {}, without bus transfers{}", 1e3 * r.modelled_seconds,
                  o.request.device.name, name_of(options_on(o.request.device).memory),
                  has_network(o) ? std::string(", ") + kNetwork : ""));
  row("simulation", job.bvh
                        ? fmt::format("{:.3g} s, {:.4g} M rays/s", r.simulation_seconds,
                                      static_cast<double>(rays) / r.simulation_seconds / 1e6)
                        : fmt::format("{:.3g} s, {:.4g} M tests/s", r.simulation_seconds,
                                      static_cast<double>(c.pairs) / r.simulation_seconds / 1e6));
  row("hits", fmt::format("{} in {}", r.hits, counted(c.records, "record")));
  row("check",
      o.check ? fmt::format("{} of {} {} the reference{}", r.matching,
                            counted(r.compared, "record"), r.compared == 1 ? "matches" : "match",
                            job.bvh ? fmt::format("; {} rays also checked against every triangle",
                                                  r.brute_force_rays)
                                    : "")
              : "off");
}

}  // namespace cde::cli
