// SPDX-License-Identifier: Apache-2.0
// Checks two spheres with the certified oracle, and reads a word of a wave as a number.
#include <cde/oracle/signed_distance.hpp>
#include <cde/wave/value.hpp>
#include <cstdio>

int main() {
  using cde::oracle::Sphere;
  const cde::oracle::SignedDistance distance =
      cde::oracle::signed_distance(Sphere{{0, 0, 0}, 1}, Sphere{{3, 0, 0}, 1});
  const auto form = cde::wave::parse_form("fp32");
  std::printf("distance %g to %g\n", distance.lo, distance.hi);
  return form && distance.lo <= 1 && 1 <= distance.hi ? 0 : 1;
}
