// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "bench/measured.hpp"
#include "bench/opencl_figures.hpp"
#include "bench/reproduce.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/support/counted.hpp"
#include "output/device_output.hpp"
#include "output/streams.hpp"
#include "page/chart.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<Cell>>;

constexpr const char* kSourceNames[] = {"paper", "card", "software", "opencl"};

int colour_of(const Entry& entry) {
  if (entry.source == Source::kPaper) return 4;
  if (entry.source == Source::kOpenCl) return 2;
  return entry.source == Source::kCard ? 1 : 0;
}

std::vector<const Entry*> of_source(const Experiment& e, Source source) {
  std::vector<const Entry*> entries;
  for (const Entry& entry : e.entries)
    if (entry.source == source) entries.push_back(&entry);
  return entries;
}

/// What the cards are compared with: software, and an OpenCL device if there is one.
std::vector<const Entry*> baselines_of(const Experiment& e) {
  std::vector<const Entry*> all = of_source(e, Source::kSoftware);
  for (const Entry* entry : of_source(e, Source::kOpenCl)) all.push_back(entry);
  return all;
}

std::string dots(const Experiment& e) {
  std::vector<Dot> list;
  for (const Entry& entry : e.entries) {
    Dot dot{.name = entry.name,
            .colour = colour_of(entry),
            .seconds = entry.seconds,
            .hollow = entry.warm,
            .note = entry.note};
    if (entry.spread) {
      dot.low = entry.spread->tenth, dot.high = entry.spread->ninetieth;
      dot.note += fmt::format("; {} to {}, {} samples", duration(dot.low), duration(dot.high),
                              entry.spread->samples);
    }
    list.push_back(std::move(dot));
  }
  return log_dots(e.title + ", time per frame", list);
}

std::string times(double ratio) {
  return ratio < 9.95 ? fmt::format("{:.2g}", ratio)
                      : grouped(static_cast<std::uint64_t>(std::llround(ratio)));
}

/// Compares a card with a baseline, both in seconds: "1.9 times slower", or "as fast" within 5 %.
std::string against(double card, double baseline) {
  const double ratio = baseline / card;
  if (ratio > 0.95 && ratio < 1.05) return "as fast";
  return fmt::format("{} times {}", times(std::max(ratio, 1 / ratio)),
                     ratio >= 1 ? "faster" : "slower");
}

/// A table of every card against every baseline.
std::string comparison_table(const Experiment& e) {
  std::vector<std::string> head = {"card"};
  for (const Entry* baseline : baselines_of(e)) head.push_back("against " + baseline->name);
  Rows rows;
  for (const Entry* card : of_source(e, Source::kCard)) {
    std::vector<Cell> row = {card->name};
    for (const Entry* baseline : baselines_of(e))
      row.push_back(Cell::figure(against(card->seconds, baseline->seconds)));
    rows.push_back(std::move(row));
  }
  return table("The cards, in modelled time, against software, measured here", head, rows);
}

std::string split_table(const std::vector<Experiment>& experiments) {
  Rows rows;
  for (const Experiment& e : experiments) {
    for (const Entry* entry : of_source(e, Source::kCard)) {
      std::vector<Cell> row = {e.title, entry->name};
      for (const double part : parts(*entry->split)) row.push_back(Cell::figure(duration(part)));
      row.push_back(Cell::figure(duration(entry->seconds)));
      rows.push_back(std::move(row));
    }
  }
  std::vector<std::string> head = {"frame", "card"};
  head.insert(head.end(), kTimeParts.begin(), kTimeParts.end());
  head.emplace_back("total");
  return table(
      "Modelled time. Tests that run during the transfer of records to the host count as bus", head,
      rows);
}

const Entry* named(const Experiment& e, std::string_view part) {
  for (const Entry& entry : e.entries)
    if (entry.name.find(part) != std::string::npos) return &entry;
  return nullptr;
}

/// The pass of a brute-force frame.
double without_bus(const Entry& brute_force) {
  return brute_force.split->compute + brute_force.split->memory;
}

double with_bus(const Counters& counters) {
  return 1e-12 * static_cast<double>(counters.time.total());
}

std::string clock_of(const Reproduction& r) {
  return fmt::format("fp32, {}", r.options.device.text());
}

/// The assumptions of the card with a BVH.
std::string bvh_card(const Reproduction& r) {
  return fmt::format("{}, {} for leaves, {}",
                     counted(r.options.device.traversal_units, "traversal unit"),
                     counted(r.options.device.leaf_lanes(), "lane"), clock_of(r));
}
constexpr const char* kBvhBus = "PCI 64/66, host profile ideal, bursts of 4,096 bytes";

std::string brute_force_card(const Reproduction& r) {
  return fmt::format("{}, {}", counted(r.options.lanes, "lane"), clock_of(r));
}

std::string embree_on(const Json& machine) {
  return fmt::format("one thread of {}", machine.value("processor", "this machine"));
}

/// A sentence about a frame of rays with all bus transfers, for the summary.
std::string bvh_in_short(const WithBvh& row) {
  const BvhFigures& f = row.figures;
  const double card = with_bus(f.cards.back().packet);
  const std::string baseline =
      f.embree ? fmt::format("; compared with Embree with fresh rays, {}, it is {}",
                             duration(f.embree->frame.fresh.median),
                             against(card, f.embree->frame.fresh.median))
               : "";
  return fmt::format(
      "{} rays against {} triangles with a BVH, which the paper does not have: a card with "
      "traversal units takes {}. Compared with brute force on the best card it is {}{}.",
      kBvhPacket, grouped(f.triangles), duration(card), against(card, row.brute_force.seconds),
      baseline);
}

/// The card with a BVH compared with brute force and Embree, without and with the bus.
std::string bvh_summary(const WithBvh& row) {
  const BvhFigures& f = row.figures;
  const Counters& packet = f.cards.back().packet;
  const double alone = f.seconds(packet.cycles), all = with_bus(packet);
  const auto said = [&](const std::string& baseline, double without, double with) {
    return fmt::format(" Compared with {} the card is {} without the bus and {} with it.", baseline,
                       against(alone, without), against(all, with));
  };
  const std::string text =
      fmt::format(
          "{} rays against {} triangles (modelled cycles): the card with "
          "traversal units and DDR-400 takes {} from go to done and {} with "
          "all bus transfers; brute force on the best card takes {} and {}.",
          kBvhPacket, grouped(f.triangles), duration(alone), duration(all),
          duration(without_bus(row.brute_force)), duration(row.brute_force.seconds)) +
      said("brute force", without_bus(row.brute_force), row.brute_force.seconds);
  if (!f.embree) return text + " Embree is not in this build of cde.";
  const double fresh = f.embree->frame.fresh.median, warm = f.embree->frame.warm.median;
  return fmt::format(
      "{} Embree takes {} for fresh rays and {} for the same rays again (measured).{}{}", text,
      duration(fresh), duration(warm), said("fresh rays", fresh, fresh),
      said("the same rays again", warm, warm));
}

std::string bvh_lines(const Reproduction& r, const Json& machine) {
  const bool embree = r.bvh.front().figures.embree.has_value();
  std::vector<Line> lines;
  const auto add = [&](const std::string& name, int colour, bool software = false) {
    lines.push_back({.name = name, .colour = colour, .dashed = software, .x = {}, .y = {}});
  };
  add("card with a BVH, without the bus (modelled)", 2);
  add("card with a BVH, with the bus (modelled)", 1);
  add(fmt::format("card, brute force with {} lanes, with the bus (modelled)", r.options.lanes), 3);
  if (embree) {
    add("Embree, fresh rays (measured)", 0, true);
    add("Embree, the same 256 rays again (measured)", 5, true);
  }
  for (const WithBvh& row : r.bvh) {
    const BvhFigures& f = row.figures;
    const Counters& packet = f.cards.back().packet;
    std::vector<double> y = {f.seconds(packet.cycles), with_bus(packet), row.brute_force.seconds};
    if (embree) y.insert(y.end(), {f.embree->frame.fresh.median, f.embree->frame.warm.median});
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k].x.push_back(static_cast<double>(f.triangles));
      lines[k].y.push_back(y[k]);
    }
  }
  return log_lines("Time of 256 rays over the number of triangles", "triangles", lines) +
         fmt::format(
             "<p class=\"note\">256 rays, nearest hits. Solid lines, modelled cycles: the card "
             "with a BVH ({}, DDR-400) and brute force on the best card ({}, ideal memory), both "
             "on {}.{}</p>\n",
             bvh_card(r), brute_force_card(r), kBvhBus,
             embree ? fmt::format(" Dashed lines, processor time of {}: Embree.",
                                  escaped(embree_on(machine)))
                    : "");
}

/// A table of the chapter, with one row per mesh and columns of the card and, if available, of
/// Embree.
template <class CardCells, class EmbreeCells>
std::string bvh_table(const Reproduction& r, const std::string& caption,
                      std::vector<std::string> head, const std::vector<std::string>& embree_head,
                      const CardCells& card, const EmbreeCells& embree) {
  const bool there = r.bvh.front().figures.embree.has_value();
  head.insert(head.begin(), "triangles");
  if (there) head.insert(head.end(), embree_head.begin(), embree_head.end());
  Rows rows;
  for (const WithBvh& row : r.bvh) {
    std::vector<std::string> cells = card(row);
    if (there) {
      const std::vector<std::string> more = embree(*row.figures.embree, row.figures);
      cells.insert(cells.end(), more.begin(), more.end());
    }
    rows.push_back({grouped(row.figures.triangles)});
    for (const std::string& cell : cells) rows.back().push_back(Cell::figure(cell));
  }
  return table(caption, head, rows);
}

std::string spread_of(const Spread& x) {
  return fmt::format("{} ({} to {})", duration(x.median), duration(x.tenth), duration(x.ninetieth));
}

std::string millions(double rays_per_second) {
  return fmt::format("{:.3g} M/s", 1e-6 * rays_per_second);
}

std::string bvh_tables(const Reproduction& r, const Json& machine) {
  const bool there = r.bvh.front().figures.embree.has_value();
  const std::string embree = there ? fmt::format("; Embree: measured, {}", embree_on(machine)) : "",
                    card = fmt::format("Card: modelled, {}, on {}", bvh_card(r), kBvhBus),
                    both = fmt::format("{}; brute force: modelled, {}, ideal memory, same bus{}",
                                       card, brute_force_card(r), embree);
  std::string html = bvh_table(
      r,
      fmt::format("256 rays. {}{}", both,
                  there ? ", median, and range from the 10th to the 90th of 100 measurements" : ""),
      {"card, ideal memory, without the bus", "card, DDR-400, without the bus",
       "card, DDR-400, with the bus", "brute force, without the bus", "brute force, with the bus"},
      {"Embree, fresh rays", "Embree, the same rays again"},
      [](const WithBvh& row) -> std::vector<std::string> {
        const BvhFigures& f = row.figures;
        return {duration(f.seconds(f.cards.front().packet.cycles)),
                duration(f.seconds(f.cards.back().packet.cycles)),
                duration(with_bus(f.cards.back().packet)), duration(without_bus(row.brute_force)),
                duration(row.brute_force.seconds)};
      },
      [](const BvhEmbree& e, const BvhFigures&) -> std::vector<std::string> {
        return {spread_of(e.frame.fresh), spread_of(e.frame.warm)};
      });
  html += bvh_table(
      r,
      fmt::format(
          "Rays in a stream: {} in the card's ring buffer without the bus, {} with it. {}{}",
          grouped(kBvhRing), grouped(r.bvh.front().figures.rays), card, embree),
      {"card, ideal memory, without the bus", "card, DDR-400, without the bus",
       "card, DDR-400, with the bus"},
      {fmt::format("Embree, {} rays", grouped(r.bvh.front().figures.rays))},
      [](const WithBvh& row) -> std::vector<std::string> {
        const BvhFigures& f = row.figures;
        const auto ring = [&](const BvhCard& c) {
          return millions(kBvhRing / f.seconds(c.ring.cycles));
        };
        const BvhCard& ddr = f.cards.back();
        return {ring(f.cards.front()), ring(ddr), millions(1 / ddr.per_ray(with_bus(ddr.stream)))};
      },
      [](const BvhEmbree& e, const BvhFigures& f) -> std::vector<std::string> {
        return {millions(static_cast<double>(f.rays) / e.stream.median)};
      });
  html += bvh_table(
      r, fmt::format("Refitting after all vertices have moved. {}{}", card, embree),
      {"card, ideal memory, without the bus", "card, DDR-400, without the bus",
       "card, DDR-400, with all triangles over the bus"},
      {"Embree, with its vertices"},
      [](const WithBvh& row) -> std::vector<std::string> {
        const BvhFigures& f = row.figures;
        return {f.refit_text(f.cards.front()), f.refit_text(f.cards.back()),
                duration(f.cards.back().update_seconds)};
      },
      [](const BvhEmbree& e, const BvhFigures&) -> std::vector<std::string> {
        return {duration(e.refit.median)};
      });
  html += bvh_table(
      r,
      fmt::format("Building once, measured on {}; upload of triangles and BVH to the card, "
                  "modelled, {}, on {}",
                  embree_on(machine), clock_of(r), kBvhBus),
      {"built by cde", "to the card, with the bus"}, {"built by Embree"},
      [](const WithBvh& row) -> std::vector<std::string> {
        return {duration(row.figures.build_seconds),
                duration(row.figures.cards.back().upload_seconds)};
      },
      [](const BvhEmbree& e, const BvhFigures&) -> std::vector<std::string> {
        return {duration(e.build_seconds)};
      });
  Rows rows;
  for (const WithBvh& row : r.bvh) {
    const BvhFigures& f = row.figures;
    const BvhCard& c = f.cards.back();
    const auto share = [&](std::uint64_t of) {
      return fmt::format("{:.2f}", c.per_ray(static_cast<double>(of)));
    };
    rows.push_back({grouped(f.triangles)});
    for (const std::string& cell :
         {fmt::format("{:.0f} %", 100 * c.per_ray(static_cast<double>(f.hits))),
          share(c.stream.nodes), share(c.stream.pairs), grouped(f.nodes), grouped(f.levels),
          fmt::format("{:.1f}", static_cast<double>(f.bytes) / static_cast<double>(f.triangles)),
          grouped(f.nodes * 72 * f.device.traversal_units)})
      rows.back().push_back(Cell::figure(cell));
  }
  return html + table("Nodes and triangles per ray, counted by the card, and size of the BVH",
                      {"triangles", "rays that hit", "nodes per ray", "triangles per ray", "nodes",
                       "levels", "bytes per triangle", "bytes of node memory on the card"},
                      rows);
}

/// The chapter that compares BVH traversal with the brute force of the figures.
std::string bvh_chapter(const Reproduction& r, const Json& machine) {
  const bool there = r.bvh.front().figures.embree.has_value();
  return fmt::format(
      "<section><h2>With a BVH</h2>\n<p>This is not in the paper: its card and the cards above "
      "test every triangle. A card with traversal units traverses a BVH and returns the same "
      "records, bit by bit. Every record was compared with the reference. The rays are the rays of "
      "Figure 5; the meshes are similar terrains.</p>\n<p>{}</p>\n<ul class=\"plain\">\n<li>The "
      "card's figures are modelled cycles of a simulated card, the same in every run. {}. Its "
      "device is {}: {}.</li>\n<li>Without the bus: from go to done; rays and records stay on the "
      "card. With "
      "the bus: including rays, records and register accesses.</li>\n<li>{}</li>\n<li>Ideal memory "
      "answers 20 cycles after a request. DDR-400 has banks, rows and refresh, and may answer "
      "sooner. Each traversal unit has its own copy of the node memory, without a cache, so warm "
      "and fresh rays are the same for the card.</li>\n</ul>\n{}{}</section>\n",
      escaped(bvh_summary(r.bvh.back())),
      there ? "Embree's figures are the median processor time of one thread of this machine, which "
              "equals wall time if nothing else runs"
            : "Embree, for comparison, is not in this build of cde",
      escaped(r.options.device.text()), escaped(r.options.device.why),
      there ? "Fresh: new rays in every frame. The same again: 256 rays in every frame, so that "
              "Embree's caches are warm."
            : "Figure 5 has software that tests every triangle.",
      bvh_lines(r, machine), bvh_tables(r, machine));
}

/// Sentences that compare card and software, from the figures of this run.
std::string summary(const Reproduction& r) {
  const Experiment& one = r.figure5.front();
  const Entry* paper_card = named(one, "as in the paper");
  const Entry* scalar = named(one, "scalar");
  std::string html = "<ul class=\"plain\">\n";
  const auto add = [&](const std::string& text) {
    html += fmt::format("<li>{}</li>\n", escaped(text));
  };
  add(fmt::format(
      "The paper's card takes {:g} ms per frame. This card, built and used in the same way, takes "
      "{} (modelled). {}",
      1e3 * kPaperCard, duration(paper_card->seconds),
      r.options.quick ? "The terrain of this run is smaller than the paper's."
                      : fmt::format("The transfer of records to the host is {:.1f} % of that.",
                                    100 * paper_card->split->bus / paper_card->seconds)));
  const double per_test = kPaperSoftware / kPaperTests;
  add(fmt::format(
      "The paper's factor of {:g} compares with software that takes {} per test, {} cycles of a "
      "2.8 GHz Xeon. Scalar software here takes {} per test; compared with it the same card would "
      "be {} times {}. Today's software is too fast for that factor, and the paper does not "
      "describe its software.",
      kPaperRatio5, duration(per_test), grouped(static_cast<std::uint64_t>(per_test * 2.8e9)),
      duration(scalar->seconds / static_cast<double>(one.tests)),
      times(std::max(scalar->seconds / paper_card->seconds, paper_card->seconds / scalar->seconds)),
      scalar->seconds > paper_card->seconds ? "faster" : "slower"));
  std::vector<Experiment> all = r.figure5;
  all.insert(all.end(), r.figure6.begin(), r.figure6.end());
  all.push_back(r.figure7.back());
  for (const Experiment& e : all) {
    const Entry& card = *named(e, "best");
    auto baselines = of_source(e, Source::kSoftware);
    baselines.erase(
        std::remove_if(baselines.begin(), baselines.end(), [](const Entry* x) { return x->warm; }),
        baselines.end());
    const Entry& baseline =
        **std::min_element(baselines.begin(), baselines.end(),
                           [](const Entry* a, const Entry* b) { return a->seconds < b->seconds; });
    add(fmt::format(
        "{}: the best card takes {}. The fastest software here, {}, takes {}. The card is {}.",
        e.title, duration(card.seconds), baseline.name, duration(baseline.seconds),
        against(card.seconds, baseline.seconds)));
  }
  add(bvh_in_short(r.bvh.back()));
  return html + "</ul>\n";
}

Rows assumptions(const Reproduction& r, const Json& machine) {
  const Device& device = r.options.device;
  Rows rows = {
      {"device", fmt::format("{}; {}. The paper names no clock.", device_row(device), device.why)},
      {"number format", "fp32 everywhere"},
      {"ray-triangle",
       "Möller and Trumbore, as in the paper; brute force: every ray against every "
       "triangle, except in the chapter “With a BVH”"},
      {"bus",
       "PCI 64 bits, 66.67 MHz, with signals simulated cycle by cycle; the work of the "
       "host's CPU between two accesses takes no time"},
      {"memory of the card",
       "one slot per cycle after a latency of 20 cycles; no refresh, no bank conflicts"}};
  for (const Setup& s : r.setups)
    rows.push_back(
        {fmt::format("card, {}", s.name),
         fmt::format("{} {}, host profile {} ({}), bursts of {} bytes", s.lanes,
                     s.lanes == 1 ? "lane" : "lanes", s.host.name, s.host.source, s.burst)});
  rows.push_back(
      {"card with traversal units", fmt::format("{}; {}, with computed, "
                                                "not simulated time; memory as stated above",
                                                bvh_card(r), kBvhBus)});
  rows.push_back({"the paper's frame",
                  "“259,572 ray-triangle tests” is read as one ray against the terrain. 256 rays "
                  "are also measured, because the register file holds 256"});
  rows.push_back(
      {"terrain", fmt::format("{} triangles, made by cde; the paper's terrain is not published",
                              grouped(r.triangles))});
  rows.push_back(
      {"moved",
       fmt::format("{} triangles at a tenth of the vertices; the paper does not say how many moved",
                   grouped(r.moved_triangles))});
  rows.push_back({"software", fmt::format("median processor time of one thread; the vectorised one "
                                          "uses {}; data is in memory; other programs may run",
                                          r.vector_kind)});
  rows.push_back(
      {"Embree",
       r.embree
           ? fmt::format(
                 "version 3, robust, one ray at a time; building its BVH once took {}, not counted",
                 duration(r.embree_build_seconds))
           : std::string("not in this build of cde")});
  if (r.options.opencl)
    rows.push_back(
        {"OpenCL", fmt::format("{}, driver {}; median wall time with copies of rays, spheres, "
                               "moved triangles and answers",
                               r.options.opencl->label(), r.options.opencl->driver)});
  for (const auto& [key, value] : machine.items())
    rows.push_back({key, value.is_string() ? value.get<std::string>() : json_text(value, -1)});
  return rows;
}

std::string sphere_lines(const Reproduction& r) {
  std::vector<Line> lines;
  std::size_t cards = 0, baselines = 0;
  for (const Entry& entry : r.figure7.front().entries) {
    const bool card = entry.source == Source::kCard;
    constexpr std::array<int, 3> kCards = {3, 2, 1}, kBaselines = {0, 5, 4};
    const int colour = card ? kCards.at(cards++) : kBaselines.at(baselines++);
    lines.push_back({.name = entry.name, .colour = colour, .dashed = !card, .x = {}, .y = {}});
  }
  for (std::size_t i = 0; i < r.spheres.size(); ++i) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k].x.push_back(static_cast<double>(r.spheres[i]));
      lines[k].y.push_back(r.figure7[i].entries[k].seconds);
    }
  }
  return log_lines("Time per frame over the number of spheres", "moving spheres", lines);
}

}  // namespace

Json reproduction_json(const Reproduction& r, const Json& machine) {
  Json j = program_json();
  j.update({{"quick", r.options.quick},
            {"device", device_json(r.options.device)},
            {"clock_hz", r.options.device.clock_hz()},
            {"machine", machine},
            {"triangles", r.triangles},
            {"moved_triangles", r.moved_triangles},
            {"records_compared", r.records_compared},
            {"vector", r.vector_kind},
            {"embree", r.embree},
            {"opencl_device", r.options.opencl ? opencl_device_json(*r.options.opencl) : Json()},
            {"cards", Json::array()},
            {"paper",
             {{"card_seconds", kPaperCard},
              {"software_seconds", kPaperSoftware},
              {"ratio_figure_5", kPaperRatio5},
              {"ratio_figure_6", kPaperRatio6},
              {"ratio_figure_7", kPaperRatio7}}}});
  for (const Setup& s : r.setups)
    j["cards"].push_back({{"name", s.name},
                          {"lanes", s.lanes},
                          {"host", s.host.name},
                          {"burst_bytes", s.burst},
                          {"all_records", s.all_records}});
  int number = 5;
  for (const auto* figure : {&r.figure5, &r.figure6, &r.figure7}) {
    Json list = Json::array();
    for (const Experiment& e : *figure) {
      Json entries = Json::array();
      for (const Entry& entry : e.entries) {
        Json one = {{"name", entry.name},
                    {"source", kSourceNames[static_cast<int>(entry.source)]},
                    {"seconds", entry.seconds},
                    {"note", entry.note}};
        if (entry.spread) one["spread"] = spread_json(*entry.spread);
        if (entry.warm) one["same_rays_again"] = true;
        if (entry.split) one["modelled_seconds"] = time_json(entry.time);
        entries.push_back(std::move(one));
      }
      list.push_back(
          {{"name", e.name}, {"title", e.title}, {"tests", e.tests}, {"entries", entries}});
    }
    j[fmt::format("figure_{}", number++)] = std::move(list);
  }
  for (const WithBvh& row : r.bvh) {
    Json one = bvh_json(row.figures);
    one["brute_force"] = {{"name", row.brute_force.name},
                          {"packet_seconds", without_bus(row.brute_force)},
                          {"packet_seconds_with_bus", row.brute_force.seconds}};
    j["bvh"].push_back(std::move(one));
  }
  return j;
}

std::string reproduction_html(const Reproduction& r, const Json& machine) {
  std::string body =
      "<main>\n<header><h1>The paper's figures, measured again</h1>\n<p "
      "class=\"lead\">“Hardware-Accelerated Ray-Triangle Intersection Testing for High-Performance "
      "Collision Detection” (Journal of WSCG 15, 2007), Figures 5, 6 and 7, compared with the "
      "simulated card of cde and with software on this machine.</p></header>\n";
  if (r.options.quick)
    body +=
        "<p><strong>A quick run: a small terrain and few spheres.</strong> Its figures show only "
        "that the tool works. Do not compare them with the paper's.</p>\n";
  body += fmt::format(
      "<section><h2>In short</h2>\n{}<p class=\"note\">Blue: modelled time of the card, the same "
      "in every run. Orange: processor time of one thread of this machine; the dot is the median, "
      "and the line goes from the 10th to the 90th of 100 measurements. Hollow: Embree with the "
      "same rays in every frame, with warmer caches than in a real frame. Grey: the paper, only "
      "for workloads with as many tests.{} All time axes are logarithmic.</p></section>\n",
      summary(r), r.options.opencl ? " Green: the OpenCL device, in wall time with copies." : "");
  body += fmt::format(
      "<section><h2>Figure 5: static objects</h2>\n<p>The paper prints {:g} ms for its card and {} "
      "ms for its CPU, “about {:g} times”, and “four times faster than the GPU”.</p>\n",
      1e3 * kPaperCard, grouped(std::llround(1e3 * kPaperSoftware)), kPaperRatio5);
  for (const Experiment& e : r.figure5)
    body += fmt::format("<h3>{}</h3>\n{}{}", escaped(e.title), dots(e), comparison_table(e));
  body += fmt::format(
      "</section>\n<section><h2>Figure 6: moving vertices</h2>\n<p>The paper prints “{:g} times "
      "faster” and no times. The moved triangles are uploaded to the card again. Software has them "
      "in memory. Embree refits its BVH.</p>\n",
      kPaperRatio6);
  for (const Experiment& e : r.figure6)
    body += fmt::format("<h3>{}</h3>\n{}{}", escaped(e.title), dots(e), comparison_table(e));
  body += fmt::format(
      "</section>\n<section><h2>Figure 7: moving spheres</h2>\n<p>The paper prints “{:g} times "
      "faster” for a thousand spheres and no times. All spheres move, so all are uploaded in every "
      "frame. Every pair is tested in both orders. Software counts overlaps and writes no "
      "records.</p>\n{}",
      kPaperRatio7, sphere_lines(r));
  body += fmt::format("<h3>{}</h3>\n{}</section>\n", escaped(r.figure7.back().title),
                      comparison_table(r.figure7.back()));
  std::vector<Experiment> all = r.figure5;
  all.insert(all.end(), r.figure6.begin(), r.figure6.end());
  all.push_back(r.figure7.back());
  body += bvh_chapter(r, machine);
  body += fmt::format("<section><h2>Where the time goes</h2>\n{}</section>\n", split_table(all));
  body += fmt::format(
      "<section><h2>Assumptions</h2>\n{}<p>{} records of the card were compared with the reference "
      "bit by bit; none differs. The hits of software equal the card's, except for rounding at "
      "edges.</p></section>\n</main>\n",
      table("Assumptions of the figures", {}, assumptions(r, machine)),
      grouped(r.records_compared));
  return page("The paper's figures, measured again", body, Json(), {&kChartScript});
}

}  // namespace cde::cli
