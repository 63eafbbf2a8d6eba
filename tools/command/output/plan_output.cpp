// SPDX-License-Identifier: Apache-2.0
#include "output/plan_output.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "cde/support/counted.hpp"
#include "output/device_output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

/// Prints text wrapped to the width of the terminal; lines after the first are indented.
void print_wrapped(const std::string& text, std::size_t indent) {
  constexpr std::size_t kWidth = 100;
  std::size_t column = indent;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t space = std::min(rest.find(' '), rest.size());
    if (column > indent && column + 1 + space > kWidth) {
      print("\n{:{}}", "", indent);
      column = indent;
    }
    print("{}{}", column > indent ? " " : "", rest.substr(0, space));
    column += space + (column > indent ? 1 : 0);
    rest.remove_prefix(std::min(space + 1, rest.size()));
  }
  print("\n");
}

std::string sentence(const Effect& e) {
  return e.cost.empty() ? e.why : fmt::format("{} [{}]", e.why, e.cost);
}

/// How a query tests its primaries and secondaries: with a BVH or by brute force.
std::string method_text(const QueryWork& w) {
  const std::string all = counted(w.tests, "test") + " in " + counted(w.rows, "row");
  if (!w.bvh) return all;
  return fmt::format("through a BVH in about {} instead of {}", counted(*w.bvh_cycles, "cycle"),
                     all);
}

std::string card_text(const BoardConfig& card) {
  return fmt::format("{} {}", card.top(), fmt::join(card.parameters(), " "));
}

}  // namespace

nlohmann::ordered_json stand_in_json(const std::optional<BuiltCard>& planned) {
  if (!planned) return {{"stands_in_for", nullptr}};
  return {{"stands_in_for",
           {{"parameters", planned->board.parameters()}, {"estimated_times", planned->times}}}};
}

std::string stand_in_text(const BoardConfig& used, const BuiltCard& planned) {
  return fmt::format(
      "the built card {} replaces the planned card {}, at an estimated {:.2f} times its time; "
      "--exact-card builds the planned one",
      card_text(used), card_text(planned.board), planned.times);
}

nlohmann::ordered_json plan_json(const Scene& scene, const Plan& plan) {
  const std::vector<std::string> parameters = plan.board.parameters();
  const ModelFile file = model_file(plan.board.top(), parameters);
  nlohmann::ordered_json j = {
      {"parameters", parameters}, {"model", file.path.string()}, {"built", file.built}};
  j.update(stand_in_json(plan.stands_in_for));
  j["device"] = device_json(scene.card.device);
  j["clock_hz"] = scene.card.device.clock_hz();
  for (const Effect& e : plan.effects)
    j["effects"].push_back({{"name", e.name},
                            {"used", e.used},
                            {"choice", e.choice},
                            {"why", e.why},
                            {"cost", e.cost}});
  for (const QueryWork& w : plan.queries) {
    const auto cycles = w.bvh_cycles ? nlohmann::ordered_json(*w.bvh_cycles) : nullptr;
    j["queries"].push_back({{"name", w.name},
                            {"primaries", w.primaries},
                            {"masked", w.masked},
                            {"secondaries", w.secondaries},
                            {"packets", w.packets},
                            {"tests", w.tests},
                            {"rows", w.rows},
                            {"through", w.bvh ? "bvh" : "brute_force"},
                            {"bvh_cycles", cycles},
                            {"most_records", w.most_records},
                            {"secondary_words", w.secondary_words},
                            {"moved_words", w.moved_words},
                            {"primary_words", w.primary_words}});
  }
  return j;
}

void print_plan(const Scene& scene, const Plan& plan) {
  constexpr std::size_t kName = 28, kChoice = 18;
  print("{}: {}, {} quer{}, {}\n", printable_name(scene.file),
        counted(scene.objects.size(), "object"), scene.queries.size(),
        scene.queries.size() == 1 ? "y" : "ies", counted(scene.frames, "frame"));
  print("device: {}\n", device_row(scene.card.device));
  print_wrapped("evidence: " + scene.card.device.why, 0);
  for (const bool used : {true, false}) {
    print("\n{}\n", used ? "in the simulated card" : "left out");
    for (const Effect& e : plan.effects) {
      if (e.used != used) continue;
      print("  {:<{}}", e.name, kName - 2);
      if (used) {
        // A long choice gets a line of its own.
        const std::size_t indent = kName + kChoice + 1;
        if (e.choice.size() > kChoice)
          print("{}\n{:{}}", e.choice, "", indent);
        else
          print("{:<{}}", e.choice, kChoice + 1);
        print_wrapped(sentence(e), indent);
      } else {
        print_wrapped(sentence(e), kName);
      }
    }
  }
  print("\nper frame\n");
  for (const QueryWork& w : plan.queries) {
    print("  {:<{}}", w.name, kName - 2);
    print_wrapped(
        fmt::format("{} primar{} in {}, {} secondar{}: {}; {} for primaries, {} for changed "
                    "secondaries, of {}",
                    w.primaries, w.primaries == 1 ? "y" : "ies", counted(w.packets, "packet"),
                    w.secondaries, w.secondaries == 1 ? "y" : "ies", method_text(w),
                    counted(w.primary_words, "word"),
                    plan.resident ? w.moved_words : w.secondary_words, w.secondary_words),
        kName);
  }
  const ModelFile file = model_file(plan.board.top(), plan.board.parameters());
  print("\nmodel      {}\n           {} ({})\n", card_text(plan.board),
        printable_name(file.path.string()),
        file.built ? "built" : "not built; the first run builds it");
  if (!plan.stands_in_for) return;
  print("           ");
  print_wrapped(stand_in_text(plan.board, *plan.stands_in_for), 11);
}

}  // namespace cde::cli
