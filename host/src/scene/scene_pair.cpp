// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/scene_pair.hpp"

#include <fmt/format.h>

#include <utility>

#include "cde/fp/number_text.hpp"
#include "cde/fp/scalars.hpp"

namespace cde {

PassPipe pipe_of(const SceneQuery& query, const BoardConfig& board) {
  PassPipe pipe;
  PairConfig& c = pipe.config;
  c.pair = query.pair;
  c.algorithm = board.algorithm;
  c.box = board.box_rule(query.pair);
  c.arithmetic = board.arithmetic;
  c.format = board.format;
  c.sat_interval = has_sat_interval(query.pair) ? board.sat_interval : 1;
  c.lanes = board.lanes;
  if (has_iterations(query.pair))
    pipe.iterations = fmt::format("{},{},{}", query.iterations.samples, query.iterations.circle,
                                  query.iterations.free);
  return pipe;
}

PairOptions options_of(const PassPipe& pipe) {
  PairOptions o;
  const PairConfig& c = pipe.config;
  o.pair = name(c.pair);
  o.algorithm = name(c.algorithm);
  o.arithmetic = c.arithmetic == Arithmetic::kRtl ? "rtl" : "host";
  o.iterations = pipe.iterations;
  o.format = c.format.name();
  o.box = c.box;
  o.sat_interval = c.sat_interval;
  return o;
}

std::string PairWords::text() const {
  const WordText words(format);
  std::string all;
  for (const auto* side : {&a, &b}) {
    if (side == &b) all += " | ";
    for (std::size_t i = 0; i < side->size(); ++i)
      all += fmt::format("{}{}", i == 0 ? "" : ",", words.hexfloat((*side)[i]));
  }
  return all;
}

PairWords pair_words(FpFormat format, std::span<const float> primary,
                     std::span<const float> secondary, bool swap) {
  PairWords words{.format = format};
  const FloatWords coding(format);
  for (const float x : primary) words.a.push_back(coding.encode(x));
  for (const float x : secondary) words.b.push_back(coding.encode(x));
  if (swap) std::swap(words.a, words.b);
  return words;
}

}  // namespace cde
