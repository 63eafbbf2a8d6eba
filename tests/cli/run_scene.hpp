// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "run_cde.hpp"

namespace cde::testing {

/// New rays per frame, moving terrain vertices: 16 lanes, the model of other tests.
inline const std::string kFlight = R"(frames = 4
[card]
lanes = 16
[[object]]
name = "terrain"
mesh = "terrain:12,9,3"
deform = { kind = "wave", vertices = [20, 45], amplitude = [0, 0, 5], period = 1, wavelength = 40 }
[[object]]
name = "rays"
random_rays = { count = 300, seed = 7 }
[object.motion]
kind = "path"
points = [[20, 20, 300], [90, 60, 250]]
duration = 0.1
)" + hit_query("terrain");

/// kFlight with another [card] section and more text at its end.
inline std::string flight(const std::string& card, const std::string& more = "") {
  std::string text = kFlight;
  return text.replace(text.find("lanes = 16"), 10, card) + more;
}

class RunScene : public Cli {
 protected:
  nlohmann::json run_json(const std::string& folder) {
    return nlohmann::json::parse(read(folder + "/run.json"));
  }
};

}  // namespace cde::testing
