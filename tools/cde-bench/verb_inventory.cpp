// SPDX-License-Identifier: Apache-2.0
// cde inventory: lists operators and latencies of the pipes from the elaborated RTL, and the
// paper's.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/card/json_keys.hpp"
#include "cde/netlist/pipe_figures.hpp"
#include "cde/support/columns.hpp"
#include "cde/support/error.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/streams.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

using netlist::Pipe;
using netlist::Profile;

struct Options {
  std::vector<std::string> pairs;
  std::string profile = "3,3,12,12,1";
  unsigned sat_interval = 1;
  bool json = false, markdown = false;
};

/// Figures of an algorithm in Tables 1 and 2 of the paper: "Hardware-Accelerated Ray-Triangle
/// Intersection Testing for High-Performance Collision Detection", Journal of WSCG 15, 2007.
struct Published {
  unsigned inputs, outputs, latency, multipliers, dividers, adders, subtractors, comparators, ands;
};
constexpr std::array<Published, 3> kPaper = {{{9, 6, 10, 27, 1, 12, 15, 8, 2},     // Möller
                                              {9, 6, 16, 27, 2, 13, 23, 6, 3},     // Badouel
                                              {15, 6, 17, 54, 1, 31, 17, 3, 2}}};  // Plücker

const Published* published(Algorithm algorithm) {
  const auto i = static_cast<std::size_t>(algorithm);
  return i < kPaper.size() ? &kPaper.at(i) : nullptr;
}

/// A row of the paper's tables: the figure of this project and the paper's.
struct Quantity {
  const char* name;
  unsigned (*here)(const Pipe&);
  unsigned Published::*there;
};
constexpr std::array<Quantity, 3> kTable1 = {
    {{"inputs", [](const Pipe& p) { return p.b_words; }, &Published::inputs},
     {"outputs", [](const Pipe& p) { return p.outputs; }, &Published::outputs},
     {"latency", [](const Pipe& p) { return p.latency; }, &Published::latency}}};
constexpr std::array<Quantity, 6> kTable2 = {
    {{"multipliers", [](const Pipe& p) { return p.operators.multipliers; },
      &Published::multipliers},
     {"dividers", [](const Pipe& p) { return p.operators.dividers; }, &Published::dividers},
     {"adders", [](const Pipe& p) { return p.operators.adders; }, &Published::adders},
     {"subtractors", [](const Pipe& p) { return p.operators.subtractors; },
      &Published::subtractors},
     {"comparators", [](const Pipe& p) { return p.operators.comparators; },
      &Published::comparators},
     {"ANDs", [](const Pipe& p) { return p.operators.mask_ands; }, &Published::ands}}};

struct Reason {
  std::optional<Algorithm> algorithm;  ///< empty: all algorithms
  std::string_view quantity, text;
};
constexpr std::array<Reason, 13> kReasons = {{
    {std::nullopt, "outputs",
     "F, T and the three words of CP leave the pipe. The paper's sixth word is the index; here the "
     "update engine counts the secondaries."},
    {std::nullopt, "ANDs",
     "Number of two-input ANDs of lane masks in the whole decision. The paper does not say how "
     "many inputs its ANDs have."},
    {Algorithm::kBadouel, "multipliers",
     "Alpha and beta are compared with the normal's dominant component, not divided by it. The "
     "paper does not name its other products."},
    {Algorithm::kBadouel, "dividers",
     "Alpha and beta stay unscaled, so only the division in the plane's equation remains."},
    {Algorithm::kBadouel, "adders",
     "Three dot products, alpha + beta and O + t D take ten. The paper does not itemise its "
     "thirteen."},
    {Algorithm::kBadouel, "subtractors",
     "Two edges, the normal, w - s, and two coordinates with their determinants take fourteen. The "
     "paper does not itemise its 23."},
    {Algorithm::kBadouel, "comparators",
     "Two choose the dominant axis, and two compare T with tmin and tmax."},
    {Algorithm::kBadouel, "latency",
     "One cycle per operator on the longest path. The paper does not draw its pipe."},
    {Algorithm::kPluecker, "inputs",
     "A triangle is its three vertices. The paper's 15 words contain precomputed edges."},
    {Algorithm::kPluecker, "latency",
     "The three edge products run in parallel. Their sum and the division follow directly."},
    {Algorithm::kPluecker, "adders",
     "Compare the sum of adders and subtractors: the sign of a term decides between the two."},
    {Algorithm::kPluecker, "subtractors",
     "As for adders: compare the sum of adders and subtractors."},
    {Algorithm::kPluecker, "comparators",
     "One more for a zero determinant and two for tmin and tmax, which the paper does not count."},
}};

std::string_view reason(Algorithm algorithm, std::string_view quantity) {
  for (const Reason& r : kReasons)
    if (r.algorithm.value_or(algorithm) == algorithm && r.quantity == quantity) return r.text;
  return "The paper does not explain its figure.";
}

struct Table {
  std::string title;
  Columns columns;
  std::vector<std::string> notes = {};

  void print(bool markdown) const {
    cli::print("{}{}\n\n{}", markdown ? "### " : "", title, columns.text(markdown));
    if (!notes.empty()) cli::print("\n");
    for (const std::string& note : notes) cli::print("- {}\n", note);
    cli::print("\n");
  }
};

/// One of the paper's tables, with each figure as "here / paper".
template <std::size_t N>
Table comparison(const std::string& title, const std::array<Quantity, N>& quantities,
                 const std::vector<Pipe>& pipes) {
  Table table{title, {.heads = {"here / paper"}, .gap = 2, .wide_markdown = true}};
  for (const Pipe& pipe : pipes) table.columns.heads.emplace_back(cde::name(pipe.algorithm));
  for (const Quantity& q : quantities) {
    std::vector<std::string> row = {q.name};
    for (const Pipe& pipe : pipes) {
      const Published* paper = published(pipe.algorithm);
      const std::string there = paper == nullptr ? "-" : fmt::to_string(paper->*q.there);
      row.push_back(fmt::format(
          "{} / {}", pipe.absent.empty() ? fmt::to_string(q.here(pipe)) : "absent", there));
      if (pipe.absent.empty() && paper != nullptr && q.here(pipe) != paper->*q.there) {
        std::string note = fmt::format("{}: {}", q.name, reason(pipe.algorithm, q.name));
        const bool of_all = std::any_of(kReasons.begin(), kReasons.end(), [&](const Reason& r) {
          return !r.algorithm && r.quantity == q.name;
        });
        if (!of_all) note = fmt::format("{}, {}", cde::name(pipe.algorithm), note);
        if (std::find(table.notes.begin(), table.notes.end(), note) == table.notes.end())
          table.notes.push_back(note);
      }
    }
    table.columns.lines.push_back(row);
  }
  return table;
}

Table all_pipes(const std::vector<Pipe>& pipes, const Profile& profile) {
  Table table{"Pipes",
              {.heads = {"pipe", "mul", "div", "sqrt", "add", "sub", "cmp", "min/max", "levels",
                         "latency", "interval"},
               .gap = 2,
               .wide_markdown = true}};
  for (const Pipe& pipe : pipes) {
    if (!pipe.absent.empty()) {
      table.columns.lines.push_back({pipe.name(), "absent", "", "", "", "", "", "", "", "", ""});
      continue;
    }
    std::vector<std::string> row = {pipe.name()};
    const netlist::Operators& o = pipe.operators;
    for (const unsigned n :
         {o.multipliers, o.dividers, o.square_roots, o.adders, o.subtractors, o.comparators,
          o.min_max, pipe.latency, pipe.latency_profile, pipe.interval})
      row.push_back(fmt::to_string(n));
    table.columns.lines.push_back(row);
  }
  table.notes = {"levels: latency in cycles if every operator takes one",
                 fmt::format("latency: in cycles if operators take {}", profile.text()),
                 "interval: cycles from one row of pairs to the next"};
  if (std::any_of(pipes.begin(), pipes.end(), [](const Pipe& p) { return !p.absent.empty(); }))
    table.notes.emplace_back("absent: the RTL has no pipe for this pair and algorithm");
  return table;
}

nlohmann::ordered_json as_json(const std::vector<Pipe>& pipes, const Profile& profile) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Pipe& pipe : pipes) {
    nlohmann::ordered_json j = {{"pair", cde::name(pipe.pair)}};
    if (pipe.pair == Pair::kRayTriangle) j["algorithm"] = cde::name(pipe.algorithm);
    j["absent"] = !pipe.absent.empty();
    if (pipe.absent.empty()) {
      const netlist::Operators& o = pipe.operators;
      j["module"] = pipe.module;
      j["operators"] = {{"multipliers", o.multipliers},   {"dividers", o.dividers},
                        {"square_roots", o.square_roots}, {"adders", o.adders},
                        {"subtractors", o.subtractors},   {"comparators", o.comparators},
                        {"min_max", o.min_max},           {"mask_ands", o.mask_ands}};
      j["input_words"] = {{"primary", pipe.a_words}, {"secondary", pipe.b_words}};
      j["output_words"] = pipe.outputs;
      j["latency_levels"] = pipe.latency;
      j["latency_cycles"] = pipe.latency_profile;
      j["initiation_interval"] = pipe.interval;
    }
    if (const Published* p = published(pipe.algorithm);
        p != nullptr && pipe.pair == Pair::kRayTriangle)
      j["paper"] = {{"inputs", p->inputs},           {"output_words", p->outputs},
                    {"latency_levels", p->latency},  {"multipliers", p->multipliers},
                    {"dividers", p->dividers},       {"adders", p->adders},
                    {"subtractors", p->subtractors}, {"comparators", p->comparators},
                    {"mask_ands", p->ands}};
    all.push_back(j);
  }
  nlohmann::ordered_json j = program_json();
  j.update({{"latency_profile",
             {{"add", profile.add},
              {"mul", profile.mul},
              {"div", profile.div},
              {"sqrt", profile.sqrt},
              {"compare", profile.cmp}}},
            {"pipes", all}});
  return j;
}

Profile parse_profile(const std::string& text) {
  Profile p;
  int end = 0;
  const bool whole = text.find_first_not_of("0123456789,") == std::string::npos &&
                     std::sscanf(text.c_str(), "%3u,%3u,%3u,%3u,%3u%n", &p.add, &p.mul, &p.div,
                                 &p.sqrt, &p.cmp, &end) == 5 &&
                     static_cast<std::size_t>(end) == text.size();
  for (const unsigned cycles : {p.add, p.mul, p.div, p.sqrt, p.cmp})
    if (!whole || cycles < 1 || cycles > 64)
      throw Error(ErrorCode::kUsage,
                  fmt::format("--latencies is {}; it must be the cycles of add, mul, div, sqrt and "
                              "compare, 1 to 64 each: 3,3,12,12,1",
                              in_quotes(text)));
  return p;
}

std::vector<Pipe> wanted_pipes(const std::vector<std::string>& names) {
  std::vector<Pipe> pipes;
  for (unsigned p = 0; p < kPairs; ++p) {
    const auto pair = static_cast<Pair>(p);
    if (!names.empty() && std::find(names.begin(), names.end(), name(pair)) == names.end())
      continue;
    if (pair == Pair::kRayTriangle) {
      for (const Algorithm a :
           {Algorithm::kBadouel, Algorithm::kMoller, Algorithm::kPluecker, Algorithm::kWatertight})
        pipes.push_back({pair, a, ""});
    } else {
      pipes.push_back({pair, Algorithm::kMoller, ""});
    }
  }
  return pipes;
}

void run(const Options& o) {
  const Profile profile = parse_profile(o.profile);
  std::vector<Pipe> pipes = wanted_pipes(o.pairs);
  check_sat_interval(o.sat_interval, std::array{Pair::kObbObb});
  for (Pipe& pipe : pipes)
    if (has_sat_interval(pipe.pair)) pipe.sat_interval = o.sat_interval;
  examine_all(pipes, profile);
  if (o.json) {
    print_json(as_json(pipes, profile));
    return;
  }
  std::vector<Pipe> triangle;
  for (const Pipe& pipe : pipes)
    if (pipe.pair == Pair::kRayTriangle) triangle.push_back(pipe);
  if (!triangle.empty()) {
    comparison(
        "Ray-triangle: words of a triangle, words of a result, latency in operator levels "
        "(the paper's Table 1)",
        kTable1, triangle)
        .print(o.markdown);
    comparison("Ray-triangle: operators (the paper's Table 2)", kTable2, triangle)
        .print(o.markdown);
  }
  all_pipes(pipes, profile).print(o.markdown);
}

}  // namespace

void add_inventory(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "inventory",
      "Count the operators of the pipes and read their latencies in the elaborated RTL. Compares "
      "the four ray-triangle algorithms with the paper's Tables 1 and 2");
  pair_value(
      verb->add_option("pair", o->pairs, "Pairs to examine: ray-triangle, sphere-sphere, ...")
          ->default_str("all"),
      "PAIR");
  text_value(verb->add_option("--latencies", o->profile,
                              "Cycles of add, mul, div, sqrt and compare for the column `latency`")
                 ->capture_default_str(),
             "A,M,D,S,C", [](const std::string& text) { (void)parse_profile(text); });
  one_of(verb->add_option("--sat-interval", o->sat_interval,
                          "Cycles from one row of obb-obb, triangle-aabb or triangle-obb pairs to "
                          "the next; with 3, candidate axes (SAT) share units")
             ->capture_default_str(),
         {"1", "3"});
  auto* json = verb->add_flag("--json", o->json, "Figures as JSON");
  quiet_flag(*verb);
  verb->add_flag("--markdown", o->markdown, "Tables in Markdown")->excludes(json);
  verb->callback([o, verb] {
    normalise_pairs(o->pairs);
    if (verb->count("--sat-interval") != 0 && !o->pairs.empty() &&
        std::none_of(o->pairs.begin(), o->pairs.end(),
                     [](const std::string& pair) { return has_sat_interval(*pair_named(pair)); }))
      cannot_combine("--sat-interval", fmt::format("{}", fmt::join(o->pairs, " ")),
                     "expected obb-obb, triangle-aabb or triangle-obb");
    run(*o);
  });
}

}  // namespace cde::cli
