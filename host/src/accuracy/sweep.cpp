// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/sweep.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "cde/support/json_text.hpp"

namespace cde::accuracy {
namespace {

using Json = nlohmann::ordered_json;

/// Some cases of one family of a pipe.
struct FamilyPart {
  std::string name;
  std::optional<oracle::Family> family;  ///< none: rays at a mesh
  std::uint64_t first = 0, cases = 0;
};

/// Cases per chunk: a second or two of one core. Rays at a whole mesh take longer each, so their
/// chunks are smaller.
constexpr std::uint64_t kChunkCases = 50'000, kChunkRays = 5'000;

/// Cuts all cases of a pipe into chunks.
std::vector<FamilyPart> parts_of(const AccuracyPipe& pipe, const SweepOptions& o) {
  std::vector<FamilyPart> parts;
  const auto wanted = [&](const std::string& name) {
    return o.families.empty() || std::ranges::find(o.families, name) != o.families.end();
  };
  for (const oracle::Family& family : oracle::families(pipe.pair))
    if (wanted(family.name)) parts.push_back({family.name, family});
  if (pipe.pair == Pair::kRayTriangle)
    for (const std::string& name : leak_families())
      if (wanted(name)) parts.push_back({name, std::nullopt});
  for (std::size_t k = 0; k < parts.size(); ++k)
    parts[k].cases = o.cases / parts.size() + (k < o.cases % parts.size() ? 1 : 0);
  std::vector<FamilyPart> chunks;
  for (const FamilyPart& part : parts) {
    const std::uint64_t most = part.family ? kChunkCases : kChunkRays;
    FamilyPart some = part;
    for (some.first = 0; some.first == 0 || some.first < part.cases; some.first += most) {
      some.cases = std::min(most, part.cases - some.first);
      chunks.push_back(some);
    }
  }
  return chunks;
}

}  // namespace

std::vector<std::string> family_names(const std::vector<AccuracyPipe>& pipes) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const AccuracyPipe& pipe : pipes)
    for (const oracle::Family& family : oracle::families(pipe.pair)) add(family.name);
  for (const AccuracyPipe& pipe : pipes)
    if (pipe.pair == Pair::kRayTriangle) std::ranges::for_each(leak_families(), add);
  return names;
}

Tally Measured::all() const {
  Tally sum;
  for (const auto& [name, tally] : families) sum.add(tally);
  return sum;
}

std::optional<std::vector<Measured>> sweep(const SweepOptions& o) {
  std::vector<std::pair<std::size_t, FamilyPart>> chunks;  // pipe number and chunk
  for (std::size_t i = 0; i < o.pipes.size(); ++i)
    for (FamilyPart& part : parts_of(o.pipes[i], o)) chunks.emplace_back(i, std::move(part));
  WorkDistributor::instance().begin(
      o.distribution,
      {{"verb", "accuracy"}, {"seed", o.seed}, {"cases", o.cases}, {"families", o.families}},
      o.quiet);
  std::vector<Measured> all;
  for (const AccuracyPipe& pipe : o.pipes) all.push_back({pipe, {}});
  const bool whole = WorkDistributor::instance().run_part(
      {.what = "accuracy",
       .chunks = chunks.size(),
       .input = [&](std::uint64_t c) -> std::optional<std::string> {
         if (c >= chunks.size()) return std::nullopt;
         const auto& [pipe, part] = chunks[c];
         return fmt::format("{}, {}, {} cases from {} on", o.pipes[pipe].name(), part.name,
                            part.cases, part.first);
       },
       .run =
           [&](std::uint64_t c, const std::string&) {
             const auto& [number, part] = chunks[c];
             const AccuracyPipe& pipe = o.pipes[number];
             const Tally tally =
                 part.family ? measured(pipe, *part.family, o.seed, part.first, part.cases)
                             : measured_leaks(pipe, part.name, o.seed, part.first, part.cases);
             return json_text(tally.to_json(), -1);
           },
       .check = [](std::uint64_t,
                   const std::string& result) { (void)Tally::from_json(parse_json(result)); },
       .take =
           [&](std::uint64_t c, const std::string& result) {
             const auto& [pipe, part] = chunks[c];
             auto& families = all[pipe].families;
             if (part.first == 0) families.emplace_back(part.name, Tally());
             families.back().second.add(Tally::from_json(parse_json(result)));
           }});
  return whole ? std::optional(std::move(all)) : std::nullopt;
}

}  // namespace cde::accuracy
