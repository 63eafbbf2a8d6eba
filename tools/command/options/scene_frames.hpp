// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "cde/scene/scene.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// Frames of a scene, both included.
struct Frames {
  std::uint32_t first = 0, last = 0;
};
/// Frames of "A..B", both included, or of "A"; all frames if the text is empty. Error kUsage for
/// frames that the scene does not have.
[[nodiscard]] Frames frames_of(const std::string& text, const Scene& scene);

CLI::Option* frames_option(CLI::App& verb, std::string& frames);

}  // namespace cde::cli
