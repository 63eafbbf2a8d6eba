// SPDX-License-Identifier: Apache-2.0
#include "options/scene_frames.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "options/values.hpp"

namespace cde::cli {

Frames frames_of(const std::string& text, const Scene& scene) {
  if (text.empty()) return {0, scene.frames - 1};
  const auto number = [&](std::string_view part) -> std::optional<std::uint32_t> {
    std::uint32_t n = 0;
    const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), n);
    if (error != std::errc() || stop != part.data() + part.size()) return std::nullopt;
    return n;
  };
  const std::size_t dots = text.find("..");
  const auto first = number(std::string_view(text).substr(0, dots));
  const auto last =
      dots == std::string::npos ? first : number(std::string_view(text).substr(dots + 2));
  if (!first || !last || *first > *last || *last >= scene.frames)
    throw Error(ErrorCode::kUsage, fmt::format("--frames is {}; it must be A..B within 0..{}",
                                               in_quotes(text), scene.frames - 1));
  return {*first, *last};
}

CLI::Option* frames_option(CLI::App& verb, std::string& frames) {
  return known_words(
      verb.add_option("--frames", frames, "Frames A..B, both included")->default_str("all"), {},
      "A..B");
}

}  // namespace cde::cli
