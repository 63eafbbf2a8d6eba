// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <string>

#include "cde/wave/decoder.hpp"

namespace cde::wave {

/// Counts the passes, from 0 in the file.
class EngineDecoder : public Decoder {
 public:
  EngineDecoder(const SignalPlace& place, Take take)
      : Decoder(place, std::move(take)),
        go_(wire("control.go_i")),
        ready_(wire("control.ready_o")),
        busy_(wire("control.busy_o")) {}

 protected:
  /// Call it at every edge of the engine's clock. True if a pass starts.
  bool count_pass() {
    const bool starts = go_.on() && ready_.on();
    if (starts || (!seen_ && busy_.on())) ++passes_;
    seen_ = true;
    return starts;
  }
  /// Number of the current or last pass.
  [[nodiscard]] std::string pass() const { return passes_ == 0 ? "" : fmt::to_string(passes_ - 1); }
  [[nodiscard]] std::uint64_t passes() const { return passes_; }
  [[nodiscard]] bool busy() const { return busy_.on(); }

 private:
  const Wire &go_, &ready_, &busy_;
  std::uint64_t passes_ = 0;
  bool seen_ = false;
};

}  // namespace cde::wave
