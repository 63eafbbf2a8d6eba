// SPDX-License-Identifier: Apache-2.0
// Decodes the candidates for one primary at the update engine.
#include "cde/wave/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cde/support/error.hpp"
#include "cde/wave/decoder.hpp"
#include "cde/wave/engine_decoder.hpp"

namespace cde::wave {
namespace {

/// Watches only the lane of its primary: a card has many lanes.
class TestedDecoder : public EngineDecoder {
 public:
  TestedDecoder(const SignalPlace& place, std::uint64_t primary, TakeTested take)
      : EngineDecoder(place, {}),
        tell_(std::move(take)),
        retire_(wire("control.retire_i")),
        row_(array("engine.row_out[#]")),
        index_(array("engine.index[#]")) {
    for (unsigned k = 0; k < row_.size(); ++k) {
      const std::uint64_t lanes = of_port("f[#]", k).size(), lane = primary % lanes;
      wanted_row_ = primary / lanes;
      const auto at = [&](std::string_view name) { return &subscribe(*of_port(name, k)[lane]); };
      ports_.push_back({at("f[#]"), at("bad[#]"), at("update.mask[#]"), at("update.hit[#]"),
                        at("update.better[#]"), at("update.t_value[#]"), at("update.t_old[#]"),
                        &subscribe(*of_port("streaming_i", k)[0])});
    }
  }

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override { return std::nullopt; }
  void finish(std::uint64_t) override {}

 protected:
  void at_edge(unsigned) override {
    if (count_pass()) began_ = edges_;
    for (unsigned k = 0; k < ports_.size(); ++k) {
      const Port& p = ports_[k];
      if (!retire_.bit(k) || row_[k]->number() != wanted_row_ || !p.mask->on() || p.streaming->on())
        continue;
      tell_({.pass = passes() == 0 ? 0 : passes() - 1,
             .cycle = edges_ - began_,
             .time = now_,
             .index = index_[k]->number().value_or(~std::uint64_t{0}),
             .f = p.f->on(),
             .bad = p.bad->on(),
             .candidate = p.hit->on(),
             .kept = p.better->on(),
             .t = p.t->number().value_or(0),
             .held = p.held->number().value_or(0)});
    }
  }

 private:
  struct Port {
    const Wire *f, *bad, *mask, *hit, *better, *t, *held, *streaming;
  };

  /// Elements of all groups for one port, lane by lane.
  [[nodiscard]] std::vector<const Signal*> of_port(std::string_view name, unsigned port) const {
    std::vector<const Signal*> all;
    for (const Element& e : place().arrays.at(fmt::format("{}{}", kResults, name)))
      if (e.indices[1] == port) all.push_back(e.signal);
    return all;
  }

  static constexpr std::string_view kResults = "engine.group[#].lanes.port[#].results.";
  TakeTested tell_;
  const Wire& retire_;
  std::vector<const Wire*> row_, index_;
  std::vector<Port> ports_;
  std::uint64_t wanted_row_ = 0, began_ = 0;
};

}  // namespace

std::unique_ptr<Decoder> tested_decoder(const SignalPlace& place, std::uint64_t primary,
                                        TakeTested take) {
  return std::make_unique<TestedDecoder>(place, primary, std::move(take));
}

}  // namespace cde::wave
