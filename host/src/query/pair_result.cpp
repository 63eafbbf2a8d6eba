// SPDX-License-Identifier: Apache-2.0
#include "cde/query/pair_result.hpp"

namespace cde {

std::string differing_fields(const PairResult& a, const PairResult& b) {
  std::string names;
  const auto look = [&](bool same, const char* name) {
    if (!same) names.append(names.empty() ? "" : ", ").append(name);
  };
  look(a.f == b.f, "F");
  look(a.bad == b.bad, "bad");
  look(a.t == b.t, "T");
  constexpr const char *kPoint[] = {"CPx", "CPy", "CPz"}, *kNormal[] = {"nx", "ny", "nz"};
  for (int k = 0; k < 3; ++k) look(a.cp[k] == b.cp[k], kPoint[k]);
  for (int k = 0; k < 3; ++k) look(a.n[k] == b.n[k], kNormal[k]);
  return names;
}

}  // namespace cde
