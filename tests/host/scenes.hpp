// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/scene/scene.hpp"
#include "testing.hpp"

/// Parts of scene files that several tests use.
namespace cde::testing {

inline const std::string kBall =
    "[[object]]\nname = \"ball\"\nsphere = { center = [1, 2, 3], radius = 0.5 }\n";
inline const std::string kRays =
    "[[object]]\nname = \"rays\"\nray = { origin = [0, 0, 0], direction = [0, 0, 1] }\n";
inline const std::string kHit =
    "[[query]]\nname = \"q\"\npair = \"ray-sphere\"\nprimaries = \"rays\"\nsecondaries = "
    "\"ball\"\n";
inline const std::string kGood = kBall + kRays + kHit;

inline void refused(const std::string& text, const std::string& why,
                    ErrorCode code = ErrorCode::kBadInput) {
  SCOPED_TRACE(text.substr(0, 2000));
  expect_error(code, why, [&] { (void)parse_scene(text, "s.toml"); });
}

}  // namespace cde::testing
