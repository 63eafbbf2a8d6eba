// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/decoder.hpp"

#include <fmt/format.h>

#include <array>

namespace cde::wave {

std::string Wire::decimal() const {
  const auto value = number();
  return value ? fmt::to_string(*value) : "x";
}

std::string Wire::hexadecimal() const {
  const auto value = number();
  return value ? fmt::format("0x{:0{}x}", *value, (bits.size() + 3) / 4) : "x";
}

const Wire& Decoder::subscribe(const Signal& signal) {
  for (const Input& input : inputs_)
    if (input.handle == signal.handle) return *input.wire;
  inputs_.push_back({signal.handle, std::make_unique<Wire>()});
  return *inputs_.back().wire;
}

const Wire& Decoder::wire(std::string_view name) {
  return subscribe(*place_.signals.at(name));
}

const Wire* Decoder::wire_if_any(std::string_view name) {
  const auto found = place_.signals.find(name);
  return found == place_.signals.end() ? nullptr : &subscribe(*found->second);
}

std::vector<const Wire*> Decoder::array(std::string_view pattern) {
  std::vector<const Wire*> all;
  for (const Element& e : place_.arrays.at(pattern)) all.push_back(&subscribe(*e.signal));
  return all;
}

Open Decoder::begin(std::string_view label) const {
  Open open;
  open.t.kind = place_.of->kind;
  open.t.label = label;
  open.t.scope = place_.scope;
  open.t.begin = now_;
  open.edge = edges_;
  return open;
}

void Decoder::end_at(Open& open, std::string outcome, std::uint64_t time, std::uint64_t edge) {
  open.t.end = time;
  open.t.outcome = std::move(outcome);
  open.t.fields.insert(open.t.fields.begin(), {"cycles", fmt::to_string(edge - open.edge)});
  take_(std::move(open.t));
}

void Decoder::leave_open(Open& open, std::uint64_t time) {
  open.t.end = time;
  open.t.outcome = "open";
  take_(std::move(open.t));
}

std::string number_text(std::string_view bits, const FpFormat& format) {
  View v;
  v.signal.width = v.width = static_cast<unsigned>(bits.size());
  v.form.kind = Form::Kind::kFloat;
  v.form.format = format;
  v.form.lane = v.width;
  return v.text(bits);
}

std::string numbers(const std::vector<const Wire*>& words, const FpFormat& format) {
  std::string text = "{";
  for (const Wire* w : words) {
    if (text.size() > 1) text += ' ';
    text += number_text(w->bits, format);
  }
  return text + "}";
}

std::optional<FpFormat> format_of(const Wire& exp_bits, const Wire& man_bits) {
  const auto e = exp_bits.number(), m = man_bits.number();
  if (!e || !m || *e < 2 || *e > 11 || *m < 1 || *m > 52) return std::nullopt;
  FpFormat format;
  format.exp_bits = static_cast<int>(*e);
  format.man_bits = static_cast<int>(*m);
  return format;
}

std::string space_name(const Wire& space) {
  constexpr std::array<const char*, 4> kNames = {"registers", "primaries", "ddr", "sram"};
  const auto number = space.number();
  if (!number) return "x";
  return *number < kNames.size() ? kNames[*number] : fmt::to_string(*number);
}

}  // namespace cde::wave
