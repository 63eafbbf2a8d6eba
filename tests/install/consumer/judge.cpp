// SPDX-License-Identifier: Apache-2.0
// Checks two spheres with the certified oracle, and reads a word of a wave as a number.
#include <cde/oracle/gap.hpp>
#include <cde/wave/value.hpp>
#include <cstdio>

int main() {
  using cde::oracle::Sphere;
  const cde::oracle::Gap gap = cde::oracle::signed_gap(Sphere{{0, 0, 0}, 1}, Sphere{{3, 0, 0}, 1});
  const auto form = cde::wave::parse_form("fp32");
  std::printf("gap %g to %g\n", gap.lo, gap.hi);
  return form && gap.lo <= 1 && 1 <= gap.hi ? 0 : 1;
}
