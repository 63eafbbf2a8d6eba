// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/cases.hpp"

#include <cstdio>

namespace cde::oracle {
namespace {

const contract::PairRow& row(Pair pair) {
  return contract::kPairTable.at(static_cast<std::size_t>(pair));
}

}  // namespace

const char* to_string(Pair pair) {
  return row(pair).name.data();  // points to a literal
}
ShapeKind primary(Pair pair) {
  return row(pair).primary;
}
ShapeKind secondary(Pair pair) {
  return row(pair).secondary;
}

std::string Case::describe() const {
  std::string out = std::string(to_string(pair)) + " seed " + std::to_string(seed) + " index " +
                    std::to_string(index) + " (" + family + "): A";
  const auto append = [&](const std::vector<double>& words) {
    char text[32];
    for (const double word : words) {
      std::snprintf(text, sizeof text, " %a", word);
      out += text;
    }
  };
  append(a);
  out += " B";
  append(b);
  return out;
}

Case generate(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  return has_ray(pair) ? detail::ray_case(pair, seed, index, format)
                       : detail::convex_case(pair, seed, index, format);
}

Case hard(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  return has_ray(pair) ? detail::hard_ray_case(pair, seed, index, format)
                       : detail::hard_convex_case(pair, seed, index, format);
}

}  // namespace cde::oracle
