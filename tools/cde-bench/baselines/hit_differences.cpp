// SPDX-License-Identifier: Apache-2.0
#include "baselines/hit_differences.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "cde/support/error.hpp"

namespace cde::baseline {

std::string HitDifferences::text() const {
  if (equal() == compared) return "all equal";
  std::string list;
  const auto add = [&](std::size_t count, const char* what) {
    if (count != 0) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, what);
  };
  add(extra_hits, "extra hits");
  add(missed_hits, "missed hits");
  add(other_t, "with another T");
  add(other_triangles, "with another triangle at the same T");
  add(rounded_t, "with T rounded otherwise");
  return list;
}

HitDifferences& HitDifferences::operator+=(const HitDifferences& other) {
  compared += other.compared;
  extra_hits += other.extra_hits;
  missed_hits += other.missed_hits;
  other_t += other.other_t;
  other_triangles += other.other_triangles;
  rounded_t += other.rounded_t;
  return *this;
}

HitDifferences compare_hits(std::span<const Record> records, std::span<const ClosestHit> hits) {
  if (records.size() != hits.size())
    throw Error(ErrorCode::kMismatch,
                fmt::format("{} hits for {} records", hits.size(), records.size()));
  HitDifferences d{.compared = hits.size()};
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Record& record = records[i];
    const ClosestHit& hit = hits[i];
    const bool met = hit.index != ~0u;
    if (met != record.f) {
      ++(met ? d.extra_hits : d.missed_hits);
    } else if (met) {
      if (!(std::abs(hit.t - record.t) <= 1e-4f * std::abs(record.t)))
        ++d.other_t;
      else if (hit.index != record.index)
        ++d.other_triangles;
      else if (std::bit_cast<std::uint32_t>(hit.t) != std::bit_cast<std::uint32_t>(record.t))
        ++d.rounded_t;
    }
  }
  return d;
}

void require_few(const HitDifferences& d, std::string_view name) {
  if (d.wrong() > d.compared / 50)
    throw Error(ErrorCode::kMismatch, fmt::format("{}: of {} rays {} differ from the reference: {}",
                                                  name, d.compared, d.wrong(), d.text()));
}

}  // namespace cde::baseline
