// SPDX-License-Identifier: Apache-2.0
#include "cde/query/record.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "support/text.hpp"

namespace cde {

namespace {
constexpr std::array<const char*, 6> kModeNames = {"nearest", "farthest", "any",
                                                   "all",     "hits",     "occluded"};
}

const char* name_of(Mode mode) {
  return text::entry(kModeNames, mode, "mode");
}

std::optional<Mode> mode_named(std::string_view name) {
  const auto* found = std::find(kModeNames.begin(), kModeNames.end(), name);
  if (found == kModeNames.end()) return std::nullopt;
  return static_cast<Mode>(found - kModeNames.begin());
}

bool same_bits(const Record& a, const Record& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.f == b.f && a.bad == b.bad && a.index == b.index && a.primary == b.primary &&
         bits(a.t) == bits(b.t) && bits(a.cp.x()) == bits(b.cp.x()) &&
         bits(a.cp.y()) == bits(b.cp.y()) && bits(a.cp.z()) == bits(b.cp.z()) &&
         bits(a.n.x()) == bits(b.n.x()) && bits(a.n.y()) == bits(b.n.y()) &&
         bits(a.n.z()) == bits(b.n.z());
}

std::string differing_fields(const Record& a, const Record& b) {
  std::string names;
  const auto look = [&](bool same, const char* name) {
    if (!same) names.append(names.empty() ? "" : ", ").append(name);
  };
  const auto word = [&](float x, float y, const char* name) {
    look(std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y), name);
  };
  look(a.primary == b.primary, "primary");
  look(a.f == b.f, "F");
  look(a.bad == b.bad, "bad");
  word(a.t, b.t, "T");
  word(a.cp.x(), b.cp.x(), "CPx");
  word(a.cp.y(), b.cp.y(), "CPy");
  word(a.cp.z(), b.cp.z(), "CPz");
  look(a.index == b.index, "index");
  word(a.n.x(), b.n.x(), "nx");
  word(a.n.y(), b.n.y(), "ny");
  word(a.n.z(), b.n.z(), "nz");
  return names;
}

}  // namespace cde
