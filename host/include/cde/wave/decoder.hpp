// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/wave/candidates.hpp"
#include "cde/wave/card_signals.hpp"
#include "cde/wave/transaction.hpp"
#include "cde/wave/value.hpp"

/// @file
/// Decoders of transactions. Each follows one kind at one place of the file.
namespace cde::wave {

/// A signal as a register samples it at an edge: the value before the edge.
struct Wire {
  std::string bits;  ///< most significant first

  [[nodiscard]] bool on() const { return !bits.empty() && bits.back() == '1'; }
  [[nodiscard]] bool off() const { return !bits.empty() && bits.back() == '0'; }
  /// Whether bit `number` is 1; bit 0 is the lowest.
  [[nodiscard]] bool bit(unsigned number) const {
    return number < bits.size() && bits[bits.size() - 1 - number] == '1';
  }
  /// The word; nothing if a bit is unknown.
  [[nodiscard]] std::optional<std::uint64_t> number() const { return word(bits); }
  [[nodiscard]] std::string decimal() const;
  [[nodiscard]] std::string hexadecimal() const;
};

/// A transaction that has not ended yet.
struct Open {
  Transaction t;
  std::uint64_t edge = 0;  ///< number of the edge of its begin
};

class Decoder {
 public:
  using Take = std::function<void(Transaction)>;
  Decoder(const SignalPlace& place, Take take) : take_(std::move(take)), place_(place) {}
  virtual ~Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// Handles a rising edge of clock `clock` of the table. Edges of the first clock are counted.
  void edge(unsigned clock, std::uint64_t time) {
    now_ = time;
    if (clock == 0) ++edges_;
    at_edge(clock);
  }
  /// Handles the end of the file: open transactions are reported as open.
  virtual void finish(std::uint64_t time) = 0;
  /// Begin of the oldest transaction that was not reported yet.
  [[nodiscard]] virtual std::optional<std::uint64_t> oldest() const = 0;

  struct Input {
    std::uint32_t handle;
    std::unique_ptr<Wire> wire;
  };
  [[nodiscard]] const std::vector<Input>& inputs() const { return inputs_; }
  [[nodiscard]] const SignalPlace& place() const { return place_; }

 protected:
  virtual void at_edge(unsigned clock) = 0;

  [[nodiscard]] const Wire& subscribe(const Signal& signal);
  [[nodiscard]] const Wire& wire(std::string_view name);
  /// A signal of the table that a card may lack; then null.
  [[nodiscard]] const Wire* wire_if_any(std::string_view name);
  [[nodiscard]] std::vector<const Wire*> array(std::string_view pattern);
  [[nodiscard]] Open begin(std::string_view label = {}) const;
  /// Ends it at this edge, with its number of cycles, and reports it.
  void end(Open& open, std::string outcome) { end_at(open, std::move(outcome), now_, edges_); }
  /// The same at an earlier edge.
  void end_at(Open& open, std::string outcome, std::uint64_t time, std::uint64_t edge);
  /// Reports a transaction that is open at the end of the file.
  void leave_open(Open& open, std::uint64_t time);

  std::uint64_t now_ = 0, edges_ = 0;

 private:
  Take take_;
  SignalPlace place_;
  std::vector<Input> inputs_;
};

template <class Value>
void field(Transaction& t, std::string_view name, const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    t.fields.emplace_back(name, std::to_string(value));
  else
    t.fields.emplace_back(name, value);
}

/// Words of a slot or of a record as numbers: "{1 0 0.5}".
[[nodiscard]] std::string numbers(const std::vector<const Wire*>& words, const FpFormat& format);
[[nodiscard]] std::string number_text(std::string_view bits, const FpFormat& format);
/// The format that the card's signals state.
[[nodiscard]] std::optional<FpFormat> format_of(const Wire& exp_bits, const Wire& man_bits);
/// "reg", "primaries", "ddr", "sram", or a number.
[[nodiscard]] std::string space_name(const Wire& space);

/// Decoder of a place if it has this type; `take` receives its transactions as they end.
[[nodiscard]] std::unique_ptr<Decoder> bus_decoder(const SignalPlace& place, Decoder::Take take);
[[nodiscard]] std::unique_ptr<Decoder> engine_decoder(const SignalPlace& place, Decoder::Take take);
[[nodiscard]] std::unique_ptr<Decoder> answer_decoder(const SignalPlace& place, Decoder::Take take);
/// Decoder for pairs of a primary at the update engine; the place must be one of tested_signals().
[[nodiscard]] std::unique_ptr<Decoder> tested_decoder(const SignalPlace& place,
                                                      std::uint64_t primary, TakeTested take);

}  // namespace cde::wave
