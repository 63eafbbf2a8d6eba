// SPDX-License-Identifier: Apache-2.0
// The visible parts of a report's page: view, charts, tables.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "output/streams.hpp"
#include "page/chart.hpp"
#include "page/page.hpp"
#include "report/report.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBars = 600;
constexpr std::size_t kMostRows = 1'000;

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : json_text(value, -1);
}

Cell figure(std::uint64_t number) {
  return Cell::figure(grouped(number));
}

/// The assumptions of the modelled times.
std::vector<std::vector<Cell>> assumptions(const Scene& scene, const Json& run) {
  const SceneCard& card = scene.card;
  const Json& board = run["plan"];
  std::vector<std::vector<Cell>> rows = {
      {"device", fmt::format("{}: {}", card.device.text(), card.device.why)},
      {"bus", text_of(run["bus"])},
      {"memory of the card", text_of(run["memory"])},
      {"number format", "fp32 (IEEE 754 binary32), round to nearest even"},
      {"arithmetic", card.arithmetic == Arithmetic::kHost
                         ? "computed by this processor, with the same bits as the gates"
                         : "gates"},
      {"latency of operators",
       fmt::format("add/mul/div/sqrt/compare: {} cycles", card.device.latencies_text())}};
  for (const Json& effect : board.value("effects", Json::array())) {
    const std::string name = effect.value("name", "");
    if (effect.value("used", false) || name == "lanes")
      rows.push_back(
          {name, fmt::format("{} ({})", effect.value("choice", ""), effect.value("why", ""))});
  }
  return rows;
}

/// Rows about this machine. Its wall times say nothing about the card.
std::vector<std::vector<Cell>> machine_rows(const Json& run) {
  std::vector<std::vector<Cell>> rows;
  for (const auto& [key, value] : run["machine"].items()) rows.push_back({key, text_of(value)});
  rows.push_back({"simulation of the card", duration(run["totals"]["simulation_seconds"])});
  rows.push_back({"reference in software", duration(run["totals"]["reference_seconds"])});
  return rows;
}

}  // namespace

std::string Report::view_html() const {
  if (!picture_) return "<p>No frame was run.</p>\n";
  const bool rays = std::ranges::any_of(
      geometry_.objects(), [](const auto& object) { return object.drawn == Drawn::kRays; });
  const bool solids =
      std::ranges::any_of(scene_.queries, [](const SceneQuery& q) { return is_solid(q.pair); });
  const std::string alt =
      fmt::format("The scene in frame {} with {}.", frame_results_.front().number,
                  !rays    ? "contacts"
                  : solids ? "rays, hits and contacts"
                           : "rays and hits");
  std::string html = fmt::format(
      "<section aria-label=\"3-D view\">\n<figure><div class=\"stage\" id=\"stage\"><img "
      "src=\"data:image/png;base64,{}\" width=\"{}\" height=\"{}\" alt=\"{}\">"
      "<svg class=\"scale\" id=\"scale\" width=\"200\" height=\"34\" role=\"img\" hidden><path/>"
      "<text x=\"196\" y=\"16\" text-anchor=\"end\"></text></svg>"
      "<svg class=\"axes\" id=\"axes\" width=\"84\" height=\"84\" role=\"img\" "
      "aria-label=\"Directions of "
      "the axes x, y and z\" hidden></svg><p class=\"readout\" id=\"readout\"></p></div>\n",
      base64({reinterpret_cast<const std::uint8_t*>(picture_->data()), picture_->size()}),
      kPictureSize.width, kPictureSize.height, alt);
  html +=
      "<div class=\"controls\" id=\"controls\" hidden><button id=\"play\" "
      "type=\"button\">Play</button><input id=\"frame\" type=\"range\" min=\"0\" value=\"0\" "
      "aria-label=\"Frame\"><output id=\"frame-text\" for=\"frame\"></output>";
  if (rays) html += "<label><input id=\"show-rays\" type=\"checkbox\" checked>rays</label>";
  html +=
      "<label><input id=\"show-hits\" type=\"checkbox\" checked>hits</label>"
      "<label>up <select id=\"up\"><option>x</option><option>y</option><option selected>z</option>"
      "</select></label><button id=\"reset\" type=\"button\">Reset view</button></div>\n";
  html += legend_html();
  html += "<figcaption>";
  if (rays)
    html +=
        "Orange: rays that hit, up to their last hit. Blue: the start of rays that miss. Red: hits "
        "of rays. ";
  if (solids)
    html +=
        "Green: contacts of solids, with the normal if the query asks for normals; white lines "
        "then join the closest points of the nearest pairs that miss. ";
  html += "Drag to turn, Shift and drag to move, wheel to zoom.";
  for (const std::string& note : notes()) html.append(" ").append(escaped(note));
  return html + "</figcaption></figure>\n</section>\n";
}

std::string Report::charts_html() const {
  if (frame_results_.empty()) return "";
  const std::size_t group = (frame_results_.size() + kMostBars - 1) / kMostBars;
  const std::size_t bars = (frame_results_.size() + group - 1) / group;
  std::vector<std::uint32_t> numbers;
  std::vector<Series> modelled, wall = {{"simulated card", 4, {}}, {"reference", 5, {}}};
  for (std::size_t k = 0; k < kTimeParts.size(); ++k)
    modelled.push_back({kTimeParts[k], static_cast<int>(k), {}});
  for (std::size_t b = 0; b < bars; ++b) {
    const std::size_t first = b * group, last = std::min(first + group, frame_results_.size());
    const auto mean = [&](auto value) {
      double sum = 0;
      for (std::size_t i = first; i < last; ++i) sum += value(frame_results_[i]);
      return sum / static_cast<double>(last - first);
    };
    numbers.push_back(frame_results_[first].number);
    for (std::size_t k = 0; k < modelled.size(); ++k)
      modelled[k].values.push_back(
          mean([k](const FrameResult& p) { return parts(p.modelled)[k]; }));
    wall[0].values.push_back(mean([](const FrameResult& p) { return p.card_seconds; }));
    wall[1].values.push_back(mean([](const FrameResult& p) { return p.reference_seconds; }));
  }
  const std::string means =
      group == 1 ? "" : fmt::format(" Each bar is the mean of {} frames.", group);
  return fmt::format(
      "<section id=\"split\"><h2>Modelled time per frame</h2>\n<p>Time that the card would take: "
      "its cycles at {:g} MHz. The table below lists the "
      "assumptions.{}</p>\n{}</section>\n<section><h2>Wall time of the simulation</h2>\n<p>Time "
      "that this machine took to simulate the card and to compute the reference. It says nothing "
      "about the speed of the card.{}</p>\n{}</section>\n",
      scene_.card.device.clock_mhz, means,
      stacked_bars("Modelled time of every frame by part", "frame", numbers, modelled), means,
      stacked_bars("Wall time of every frame", "frame", numbers, wall));
}

/// The chart over the frames: the signed distance of solids, or T of rays.
std::string Report::distances_html() const {
  const std::size_t group = (frame_results_.size() + kMostBars - 1) / kMostBars;
  std::string html =
      "<section id=\"distances\"><h2>Signed distance or T over time</h2>\n<p>For solids, the "
      "signed "
      "distance: below 0 it is the depth. For rays, T of the hits, in lengths of the ray's "
      "direction. The lines are the least and the most of a frame's records; a frame without a "
      "value leaves a hole.</p>\n";
  for (std::size_t q = 0; q < scene_.queries.size(); ++q) {
    const SceneQuery& query = scene_.queries[q];
    Line least{.name = "least", .colour = 1, .x = {}, .y = {}};
    Line most{.name = "most", .colour = 4, .x = {}, .y = {}};
    bool any = false;
    for (std::size_t first = 0; first < frame_results_.size(); first += group) {
      float low = NAN, high = NAN;
      for (std::size_t i = first; i < std::min(first + group, frame_results_.size()); ++i) {
        low = std::fmin(low, frame_results_[i].distances[q][0]);
        high = std::fmax(high, frame_results_[i].distances[q][1]);
      }
      for (Line* line : {&least, &most})
        line->x.push_back(seconds(scene_, frame_results_[first].number));
      least.y.push_back(low), most.y.push_back(high);
      any = any || std::isfinite(low);
    }
    html += fmt::format("<h3>{} ({})</h3>\n", escaped(query.name), name(query.pair));
    html += any ? linear_lines(query.name + ", signed distance or T over time", "seconds",
                               {most, least})
                : std::string("<p>No record has a signed distance or T.</p>\n");
  }
  return html + "</section>\n";
}

std::string Report::tables_html(const Json& run) const {
  std::vector<std::vector<Cell>> queries;
  for (std::size_t q = 0; q < scene_.queries.size(); ++q) {
    const SceneQuery& query = scene_.queries[q];
    std::array<std::uint64_t, 5> sums{};
    for (const Json& frame : run["frame_results"]) {
      const Json& answer = frame["queries"][q];
      std::size_t k = 0;
      sums[k++] += answer["counters"]["tests"].get<std::uint64_t>();
      for (const char* key : {"records", "hits", "records_compared", "mismatches"})
        sums[k++] += answer[key].get<std::uint64_t>();
    }
    std::vector<Cell> row = {query.name, name(query.pair), name_of(query.mode)};
    for (const std::uint64_t sum : sums) row.push_back(figure(sum));
    queries.push_back(std::move(row));
  }
  std::string html = "<section><h2>Answers and checks</h2>\n";
  if (run["check"] == "none") html += "<p>The check was skipped: no record was compared.</p>\n";
  html += table(run["finished"] ? "All frames of the run" : "Frames of the run",
                {"query", "pair", "mode", "tests", "records", "hits", "compared with the reference",
                 "differ"},
                queries);
  html += "</section>\n<section><h2>Assumptions</h2>\n";
  html += table("Assumptions of the modelled times", {}, assumptions(scene_, run));
  html += table("Machine of the wall times", {}, machine_rows(run));
  std::vector<std::vector<Cell>> frames;
  for (std::size_t i = 0; i < std::min(frame_results_.size(), kMostRows); ++i) {
    const FrameResult& p = frame_results_[i];
    std::vector<Cell> row = {fmt::format("{}", p.number), figure(p.records), figure(p.hits)};
    for (const double part : parts(p.modelled)) row.push_back(Cell::figure(duration(part)));
    row.push_back(Cell::figure(duration(p.modelled.total())));
    frames.push_back(std::move(row));
  }
  std::vector<std::string> head = {"frame", "records", "hits"};
  head.insert(head.end(), kTimeParts.begin(), kTimeParts.end());
  head.emplace_back("total");
  html += fmt::format(
      "<details><summary>Figures of the chart</summary>{}</details></section>\n",
      table(frame_results_.size() > kMostRows ? "Modelled; the first 1,000 frames, run.json has all"
                                              : "Modelled",
            head, frames));
  return html;
}

}  // namespace cde::cli
