// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/packed.hpp"

#include <zlib.h>

#include <algorithm>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/wave/four_state.hpp"

namespace cde::wave {

void Packed::add_time(std::uint64_t time) {
  std::uint64_t step = time - last_time_;
  last_time_ = time;
  ++changes_;
  for (; step >= 0x80; step >>= 7) times_.push_back(static_cast<char>(step | 0x80));
  times_.push_back(static_cast<char>(step));
}

void Packed::add(std::uint64_t time, std::string_view value) {
  if (changes_ != 0 && value == last_) return;
  if (changes_ > 1 && time == last_time_ && value == before_) {
    // A change that vanishes within its instant is no change.
    values_.resize(values_.size() - values_.size() / changes_);
    times_.resize(last_length_);
    last_time_ = before_time_;
    last_ = value;
    --changes_;
    return;
  }
  if (changes_ != 0 && time == last_time_) {
    // The last of several values at one time counts.
    last_ = value;
    values_.resize(values_.size() - values_.size() / changes_);
  } else {
    before_ = std::exchange(last_, std::string(value));
    before_time_ = last_time_;
    last_length_ = times_.size();
    add_time(time);
  }
  if (text_)
    add_text(value);
  else
    add_bits(value);
}

void Packed::add_bits(std::string_view bits) {
  const std::size_t plane = (std::size_t{width_} + 7) / 8;
  if (planes_ == 1 && bits.find_first_not_of("01lLhH") != std::string_view::npos) second_plane();
  const std::size_t at = values_.size();
  values_.resize(at + plane * planes_);
  const std::size_t pad = plane * 8 - width_, size = std::min<std::size_t>(bits.size(), width_);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t place = pad + i;
    const auto mask = static_cast<char>(0x80u >> place % 8);
    const char c = four_state(bits[i]);
    if (c != '0' && c != 'z') values_[at + place / 8] |= mask;
    if (c != '0' && c != '1') values_[at + plane + place / 8] |= mask;
  }
}

void Packed::second_plane() {
  const std::size_t plane = (std::size_t{width_} + 7) / 8;
  std::string wide;
  for (std::size_t at = 0; at < values_.size(); at += plane)
    wide.append(values_, at, plane).append(plane, '\0');
  values_ = std::move(wide);
  planes_ = 2;
}

void Packed::add_text(std::string_view text) {
  const auto [found, is_new] =
      numbers_.try_emplace(std::string(text), static_cast<std::uint32_t>(texts_.size()));
  if (is_new) texts_.emplace_back(text);
  for (unsigned byte = 0; byte < 4; ++byte)
    values_.push_back(static_cast<char>(found->second >> 8 * byte));
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  // Level 4 is much faster than the default and compresses slightly less.
  const int status =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 4);
  if (status != Z_OK) throw Error(ErrorCode::kFile, "zlib does not compress the waves");
  packed.resize(size);
  return packed;
}

}  // namespace cde::wave
