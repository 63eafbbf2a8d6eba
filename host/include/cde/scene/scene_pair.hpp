// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cde/card/pipe_options.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// @file
/// A pair of a card's pass, as input of its pipe alone.
namespace cde {

struct PassPipe {
  PairConfig config;
  std::string iterations;  ///< iterations as `cde query` takes them; may be empty
};
/// The pipe of a scene's query on a card.
[[nodiscard]] PassPipe pipe_of(const SceneQuery& query, const BoardConfig& board);

/// Command options that select the pipe.
[[nodiscard]] PairOptions options_of(const PassPipe& pipe);

/// Words of the pair's first and second shape. With `swap` the secondary is the first one.
struct PairWords {
  FpFormat format = {};
  std::vector<std::uint64_t> a = {}, b = {};
  /// The pair as an operand of a command: "0x1p+0,... | ...".
  [[nodiscard]] std::string text() const;
};
[[nodiscard]] PairWords pair_words(FpFormat format, std::span<const float> primary,
                                   std::span<const float> secondary, bool swap);

}  // namespace cde
