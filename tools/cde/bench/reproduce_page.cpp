// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/reproduce.hpp"
#include "output/json_keys.hpp"
#include "output/streams.hpp"
#include "page/chart.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<Cell>>;

constexpr const char* kSourceNames[] = {"paper", "card", "software"};

int colour_of(const Entry& entry) {
  if (entry.source == Source::kPaper) return 4;
  return entry.source == Source::kCard ? 1 : 0;
}

std::vector<const Entry*> of_source(const Experiment& e, Source source) {
  std::vector<const Entry*> entries;
  for (const Entry& entry : e.entries)
    if (entry.source == source) entries.push_back(&entry);
  return entries;
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
  return log_dots(e.title + ", time of a frame", list);
}

std::string times(double ratio) {
  return ratio < 9.95 ? fmt::format("{:.2g}", ratio)
                      : grouped(static_cast<std::uint64_t>(std::llround(ratio)));
}

/// "1.9 times slower", or within 5 % "as fast": a card against a rival.
std::string against(const Entry& card, const Entry& rival) {
  const double ratio = rival.seconds / card.seconds;
  if (ratio > 0.95 && ratio < 1.05) return "as fast";
  return fmt::format("{} times {}", times(std::max(ratio, 1 / ratio)),
                     ratio >= 1 ? "faster" : "slower");
}

/// Every card against everything that this machine ran.
std::string verdict(const Experiment& e) {
  std::vector<std::string> head = {"card"};
  for (const Entry* rival : of_source(e, Source::kSoftware))
    head.push_back("against " + rival->name);
  Rows rows;
  for (const Entry* card : of_source(e, Source::kCard)) {
    std::vector<Cell> row = {card->name};
    for (const Entry* rival : of_source(e, Source::kSoftware))
      row.push_back(Cell::figure(against(*card, *rival)));
    rows.push_back(std::move(row));
  }
  return table("The cards are, in modelled time against time measured here", head, rows);
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
  return table("Modelled time; tests that run while records travel to the host count as bus", head,
               rows);
}

const Entry* named(const Experiment& e, std::string_view part) {
  for (const Entry& entry : e.entries)
    if (entry.name.find(part) != std::string::npos) return &entry;
  return nullptr;
}

/// Sentences on who wins, from the figures of this run.
std::string summary(const Reproduction& r) {
  const Experiment& one = r.figure5.front();
  const Entry* paper_card = named(one, "as in the paper");
  const Entry* scalar = named(one, "scalar");
  std::string html = "<ul class=\"plain\">\n";
  const auto say = [&](const std::string& text) {
    html += fmt::format("<li>{}</li>\n", escaped(text));
  };
  say(fmt::format(
      "The paper's card takes {:g} ms a frame; this one, built and used like it, {} (modelled). {}",
      1e3 * kPaperCard, duration(paper_card->seconds),
      r.options.quick ? "The terrain of this run is smaller than the paper's."
                      : fmt::format("{:.1f} % of that is the way of the records to the host.",
                                    100 * paper_card->split->bus / paper_card->seconds)));
  const double per_test = kPaperSoftware / kPaperTests;
  say(fmt::format(
      "The paper's factor of {:g} is against software that takes {} a test, {} clocks of a 2.8 "
      "GHz Xeon. Scalar software here takes {} a test: against it the same card would be {} times "
      "{}. The factor cannot be had against software of today, and the paper does not say what its "
      "software did.",
      kPaperRatio5, duration(per_test), grouped(static_cast<std::uint64_t>(per_test * 2.8e9)),
      duration(scalar->seconds / static_cast<double>(one.tests)),
      times(std::max(scalar->seconds / paper_card->seconds, paper_card->seconds / scalar->seconds)),
      scalar->seconds > paper_card->seconds ? "faster" : "slower"));
  std::vector<Experiment> all = r.figure5;
  all.insert(all.end(), r.figure6.begin(), r.figure6.end());
  all.push_back(r.figure7.back());
  for (const Experiment& e : all) {
    const Entry& card = *named(e, "best");
    auto rivals = of_source(e, Source::kSoftware);
    rivals.erase(
        std::remove_if(rivals.begin(), rivals.end(), [](const Entry* x) { return x->warm; }),
        rivals.end());
    const Entry& rival =
        **std::min_element(rivals.begin(), rivals.end(),
                           [](const Entry* a, const Entry* b) { return a->seconds < b->seconds; });
    say(fmt::format(
        "{}: the best card takes {}, the fastest software here, {}, {}. The card is {}.", e.title,
        duration(card.seconds), rival.name, duration(rival.seconds), against(card, rival)));
  }
  return html + "</ul>\n";
}

Rows assumptions(const Reproduction& r, const Json& machine) {
  Rows rows = {
      {"core clock", fmt::format("{:g} MHz, {}; the paper names none", r.options.clock_hz / 1e6,
                                 r.options.clock_is)},
      {"number format", "fp32 everywhere"},
      {"ray-triangle",
       "Möller and Trumbore, as in the paper; every ray against every triangle, no "
       "acceleration structure on the card"},
      {"bus",
       "PCI 64 bits, 66.67 MHz, its signals simulated clock by clock; what the host's CPU does "
       "between two accesses takes no time"},
      {"memory of the card", "a slot a clock behind 20 clocks; no refresh, no bank conflicts"}};
  for (const Setup& s : r.setups)
    rows.push_back(
        {fmt::format("card, {}", s.name),
         fmt::format("{} {}, host profile {} ({}), bursts of {} bytes", s.lanes,
                     s.lanes == 1 ? "lane" : "lanes", s.host.name, s.host.source, s.burst)});
  rows.push_back({"size of the best card",
                  "nobody has placed it in an FPGA; whether one takes it at "
                  "this clock is open"});
  rows.push_back({"the paper's frame",
                  "“259,572 ray-triangle tests”: read as one ray against the terrain. "
                  "256 rays are measured too, since that is what its register file holds"});
  rows.push_back({"terrain", fmt::format("{} triangles, made by cde; the paper's is not published",
                                         grouped(r.triangles))});
  rows.push_back(
      {"moved", fmt::format("{} triangles at a tenth of the vertices; how many the paper moved it "
                            "does not say",
                            grouped(r.moved_triangles))});
  rows.push_back(
      {"software",
       fmt::format("median processor time of one thread; {} for the vectorised one; data "
                   "in memory, other programs may run",
                   r.vector_kind)});
  rows.push_back(
      {"Embree",
       r.embree
           ? fmt::format("version 3, robust, one ray at a time; its hierarchy took {} to build, "
                         "once, not counted",
                         duration(r.embree_build_seconds))
           : std::string("not in this build of cde")});
  for (const auto& [key, value] : machine.items())
    rows.push_back({key, value.is_string() ? value.get<std::string>() : json_text(value, -1)});
  return rows;
}

std::string sphere_lines(const Reproduction& r) {
  std::vector<Line> lines;
  std::size_t cards = 0, rivals = 0;
  for (const Entry& entry : r.figure7.front().entries) {
    const bool card = entry.source == Source::kCard;
    constexpr std::array<int, 3> kCards = {3, 2, 1}, kRivals = {0, 5, 4};
    const int colour = card ? kCards.at(cards++) : kRivals.at(rivals++);
    lines.push_back({.name = entry.name, .colour = colour, .dashed = !card, .x = {}, .y = {}});
  }
  for (std::size_t i = 0; i < r.spheres.size(); ++i) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k].x.push_back(static_cast<double>(r.spheres[i]));
      lines[k].y.push_back(r.figure7[i].entries[k].seconds);
    }
  }
  return log_lines("Time of a frame over the number of spheres", "moving spheres", lines);
}

}  // namespace

Json reproduction_json(const Reproduction& r, const Json& machine) {
  Json j = program_json();
  j.update({{"quick", r.options.quick},
            {"clock_hz", r.options.clock_hz},
            {"clock_is", r.options.clock_is},
            {"machine", machine},
            {"triangles", r.triangles},
            {"moved_triangles", r.moved_triangles},
            {"records_compared", r.records_compared},
            {"vector", r.vector_kind},
            {"embree", r.embree},
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
        if (entry.spread) {
          const Spread& x = *entry.spread;
          one["spread"] = {{"least", x.least},   {"tenth", x.tenth},
                           {"median", x.median}, {"ninetieth", x.ninetieth},
                           {"most", x.most},     {"measurements", x.samples}};
        }
        if (entry.warm) one["same_rays_again"] = true;
        if (entry.split) one["modelled_seconds"] = time_json(entry.time);
        entries.push_back(std::move(one));
      }
      list.push_back(
          {{"name", e.name}, {"title", e.title}, {"tests", e.tests}, {"entries", entries}});
    }
    j[fmt::format("figure_{}", number++)] = std::move(list);
  }
  return j;
}

std::string reproduction_html(const Reproduction& r, const Json& machine) {
  std::string body =
      "<main>\n<header><h1>The paper's figures, measured again</h1>\n<p class=\"lead\">“Hardware-"
      "Accelerated Ray-Triangle Intersection Testing for High-Performance Collision Detection” "
      "(Journal of WSCG 15, 2007), Figures 5, 6 and 7, beside the simulated card of cde and "
      "software "
      "on this machine.</p></header>\n";
  if (r.options.quick)
    body +=
        "<p><strong>A quick run: a small terrain and few spheres.</strong> Its figures show that "
        "the tool "
        "works, and are not to be compared with the paper's.</p>\n";
  body += fmt::format(
      "<section><h2>In short</h2>\n{}<p class=\"note\">Blue: modelled time of the card. Orange: "
      "processor time of "
      "one thread of this machine, the dot the median and the line from the tenth to the ninetieth "
      "of "
      "a hundred measurements; modelled times are the same every time. Hollow: Embree with the "
      "same "
      "rays again and again, whose caches no frame would find so warm. Grey: the paper, only "
      "beside "
      "a workload of as many tests as its own. All axes of time are logarithmic.</p></section>\n",
      summary(r));
  body += fmt::format(
      "<section><h2>Figure 5: static objects</h2>\n<p>The paper prints {:g} ms for its card and {} "
      "ms for "
      "its CPU, “about {:g} times”, and “four times faster than the GPU”.</p>\n",
      1e3 * kPaperCard, grouped(std::llround(1e3 * kPaperSoftware)), kPaperRatio5);
  for (const Experiment& e : r.figure5)
    body += fmt::format("<h3>{}</h3>\n{}{}", escaped(e.title), dots(e), verdict(e));
  body += fmt::format(
      "</section>\n<section><h2>Figure 6: moving vertices</h2>\n<p>The paper prints “{:g} times "
      "faster” "
      "and no times. The card is given the moved triangles again; software finds them in its "
      "memory; "
      "Embree refits its hierarchy.</p>\n",
      kPaperRatio6);
  for (const Experiment& e : r.figure6)
    body += fmt::format("<h3>{}</h3>\n{}{}", escaped(e.title), dots(e), verdict(e));
  body += fmt::format(
      "</section>\n<section><h2>Figure 7: moving spheres</h2>\n<p>The paper prints “{:g} times "
      "faster” "
      "for a thousand spheres and no times. All spheres move, so all are uploaded in every frame, "
      "and "
      "every pair is tested from both sides. Software counts overlaps and writes nothing.</p>\n{}",
      kPaperRatio7, sphere_lines(r));
  body += fmt::format("<h3>{}</h3>\n{}</section>\n", escaped(r.figure7.back().title),
                      verdict(r.figure7.back()));
  std::vector<Experiment> all = r.figure5;
  all.insert(all.end(), r.figure6.begin(), r.figure6.end());
  all.push_back(r.figure7.back());
  body += fmt::format("<section><h2>Where the time goes</h2>\n{}</section>\n", split_table(all));
  body += fmt::format(
      "<section><h2>Assumptions</h2>\n{}<p>{} records of the card were compared with the reference "
      "bit by bit; none differs. The hits of software are the card's but for roundings at "
      "edges.</p>"
      "</section>\n</main>\n",
      table("Everything the figures rest on", {}, assumptions(r, machine)),
      grouped(r.records_compared));
  return page("The paper's figures, measured again", body, Json(), {&kChartScript});
}

}  // namespace cde::cli
