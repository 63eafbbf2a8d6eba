// SPDX-License-Identifier: Apache-2.0
// Decodes the engine's inputs: passes, primaries, secondaries.
#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "cde/geometry/pair.hpp"
#include "cde/query/record.hpp"
#include "cde/wave/engine_decoder.hpp"

namespace cde::wave {
namespace {

unsigned ones(const Wire& w) {
  return static_cast<unsigned>(std::count(w.bits.begin(), w.bits.end(), '1'));
}

std::string pair_text(std::uint64_t code) {
  const std::string_view text = code < kPairs ? name(static_cast<Pair>(code)) : "";
  return text.empty() ? fmt::to_string(code) : std::string(text);
}

class PassDecoder : public EngineDecoder {
 public:
  PassDecoder(const SignalPlace& place, Take take)
      : EngineDecoder(place, std::move(take)),
        done_(wire("control.done_o")),
        abort_(wire("control.abort_i")),
        mode_(wire("control.command_i.mode")),
        pair_(wire("control.command_i.pair[0]")),
        second_pair_(wire("control.command_i.pair[1]")),
        primaries_(wire("control.command_i.primaries")),
        count_(wire("control.command_i.count")),
        objects_(wire("control.command_i.objects")),
        issue_(wire("control.issue_o.valid")),
        pop_(wire("control.secondary_pop_o")),
        bubble_(wire("control.bubble_o")),
        stall_(wire("control.stall_o")),
        writeback_(wire("control.writeback_o.valid")),
        record_(wire("records.write_o")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (!open_) return std::nullopt;
    return open_->t.begin;
  }
  void finish(std::uint64_t time) override {
    if (!open_) return;
    describe();
    leave_open(*open_, time);
  }

 protected:
  void at_edge(unsigned) override {
    const bool starts = count_pass();
    if (!open_ && (starts || busy())) start();
    if (!open_) return;
    rows_ += ones(issue_);
    tested_ += pop_.on() ? 1 : 0;
    bubbles_ += bubble_.on() ? 1 : 0;
    stalls_ += stall_.on() ? 1 : 0;
    writeback_cycles_ += writeback_.on() ? 1 : 0;
    records_ += record_.on() ? 1 : 0;
    aborted_ = aborted_ || (abort_.on() && !starts);
    if (done_.on() || (!starts && !busy())) {
      describe();
      end(*open_, aborted_ ? "aborted" : "done");
      open_.reset();
    }
  }

 private:
  void start() {
    open_ = begin();
    rows_ = tested_ = bubbles_ = stalls_ = writeback_cycles_ = records_ = 0;
    aborted_ = false;
    Transaction& t = open_->t;
    const auto mode = mode_.number(), pair = pair_.number(), second = second_pair_.number();
    field(t, "pass", pass());
    mode_text_ =
        mode && *mode <= card::kModeHits ? name_of(static_cast<Mode>(*mode)) : mode_.decimal();
    field(t, "mode", mode_text_);
    pairs_ = pair ? pair_text(*pair) : "x";
    field(t, "pair", pairs_);
    if (second && *second != kNoPair) {
      field(t, "second_pair", pair_text(*second));
      pairs_ += " and " + pair_text(*second);
    }
    field(t, "primaries", primaries_.decimal());
    if (objects_.number() == 0)
      field(t, "secondaries", count_.decimal());
    else
      field(t, "objects", objects_.decimal());
  }
  void describe() {
    Transaction& t = open_->t;
    t.stalls = stalls_;
    field(t, "tested", tested_);
    field(t, "rows", rows_);
    field(t, "records", records_);
    field(t, "bubbles", bubbles_);
    field(t, "writeback", writeback_cycles_);
    t.label = fmt::format("pass {}: {}, {}, {} primaries, {} secondaries tested, {} records",
                          t.fields[0].second, pairs_, mode_text_, primaries_.decimal(), tested_,
                          records_);
  }

  const Wire &done_, &abort_, &mode_, &pair_, &second_pair_, &primaries_, &count_, &objects_,
      &issue_, &pop_, &bubble_, &stall_, &writeback_, &record_;
  std::optional<Open> open_;
  std::string pairs_, mode_text_;
  std::uint64_t rows_ = 0, tested_ = 0, bubbles_ = 0, stalls_ = 0, writeback_cycles_ = 0,
                records_ = 0;
  bool aborted_ = false;
};

/// Decodes primaries. Reports each one when its pass has begun and says whether it is in contract.
class PrimaryDecoder : public EngineDecoder {
 public:
  PrimaryDecoder(const SignalPlace& place, Take take)
      : EngineDecoder(place, std::move(take)),
        commit_(wire("engine.primaries.commit")),
        write_(wire("engine.primaries.write_i")),
        number_(wire("engine.primaries.number")),
        bad_(wire("engine.prim_bad_o")),
        clear_(wire("control.clear_o")),
        exp_(wire("registers.caps.exp")),
        man_(wire("registers.caps.man")),
        lanes_(wire("registers.caps.lanes")),
        pose_(wire_if_any("engine.primaries.pose_i")),
        pose_number_(wire_if_any("engine.primaries.pose_number_i")),
        posed_(wire_if_any("engine.primaries.commit_o")),
        slot_(array("engine.primaries.slot[#]")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    std::optional<std::uint64_t> first;
    if (coming_) first = coming_->t.begin;
    for (const Loaded& l : loaded_)
      first = std::min(first.value_or(l.open.t.begin), l.open.t.begin);
    return first;
  }
  void finish(std::uint64_t time) override {
    for (Loaded& l : loaded_) close(l, "loaded");
    loaded_.clear();
    if (coming_) leave_open(*coming_, time);
    coming_.reset();
  }

 protected:
  void at_edge(unsigned clock) override {
    if (clock == 0)
      bus_edge();
    else
      engine_edge();
  }

 private:
  struct Loaded {
    Open open;
    std::uint64_t primary = 0, time = 0, edge = 0;
  };

  void bus_edge() {
    if (!write_.on()) return;
    if (!coming_) coming_ = begin("a primary");
    if (!commit_.on()) return;
    load(std::move(*coming_), number_.number().value_or(0), "bus");
    coming_.reset();
  }
  void engine_edge() {
    // The first cycle of a pass says which primaries it takes. Until then the checks apply to
    // another pair.
    count_pass();
    if (pose_ != nullptr && posed_ != nullptr && pose_number_ != nullptr && pose_->on() &&
        posed_->on())
      load(begin(), pose_number_->number().value_or(0), "transformer");
    if (clear_.on() && !cleared_) {
      for (Loaded& l : loaded_) {
        field(l.open.t, "pass", pass());
        close(l, bad_.bit(static_cast<unsigned>(l.primary)) ? "bad" : "good");
      }
      loaded_.clear();
    }
    cleared_ = clear_.on();
  }
  void load(Open open, std::uint64_t primary, std::string_view source) {
    const auto before = std::find_if(loaded_.begin(), loaded_.end(),
                                     [&](const Loaded& l) { return l.primary == primary; });
    if (before != loaded_.end()) {
      close(*before, "replaced");
      loaded_.erase(before);
    }
    Transaction& t = open.t;
    const std::uint64_t lanes = std::max<std::uint64_t>(lanes_.number().value_or(1), 1);
    field(t, "primary", primary);
    field(t, "row", primary / lanes);
    field(t, "lane", primary % lanes);
    field(t, "source", std::string(source));
    std::string operand;
    if (const auto format = format_of(exp_, man_); format && source == "bus") {
      operand = numbers(slot_, *format);
      field(t, "operand", operand);
    }
    t.label = fmt::format("primary {}{}{}", primary, operand.empty() ? "" : " ", operand);
    loaded_.push_back({std::move(open), primary, now_, edges_});
  }
  void close(Loaded& l, std::string outcome) { end_at(l.open, std::move(outcome), l.time, l.edge); }

  const Wire &commit_, &write_, &number_, &bad_, &clear_, &exp_, &man_, &lanes_;
  const Wire *pose_, *pose_number_, *posed_;
  std::vector<const Wire*> slot_;
  std::optional<Open> coming_;
  std::deque<Loaded> loaded_;
  bool cleared_ = false;
};

class SecondaryDecoder : public EngineDecoder {
 public:
  SecondaryDecoder(const SignalPlace& place, Take take)
      : EngineDecoder(place, std::move(take)),
        pop_(wire("control.secondary_pop_o")),
        valid_(wire("control.secondary_valid_i")),
        start_(wire("control.fetch_start_o")),
        done_(wire("control.done_o")),
        flush_(wire("control.flush_o")),
        issue_(wire("control.issue_o.valid")),
        stall_(wire("control.stall_o")),
        taken_(wire("secondaries.taken")),
        requested_(wire("secondaries.slot_requested")),
        number_(wire("secondaries.slot_number")),
        index_(wire("secondaries.index_o")),
        bad_(wire("secondaries.bad_o")),
        exp_(wire("registers.caps.exp")),
        man_(wire("registers.caps.man")),
        slot_(array("secondaries.slot_o[#]")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (!fetched_.empty()) return fetched_.front().open.t.begin;
    if (half_) return half_->t.begin;
    return std::nullopt;
  }
  void finish(std::uint64_t time) override {
    for (Fetched& f : fetched_) leave_open(f.open, time);
    fetched_.clear();
  }

 protected:
  void at_edge(unsigned) override {
    (void)count_pass();
    if (start_.on() || flush_.on() || done_.on()) drop();
    fetch();
    if (valid_.on()) follow_head();
  }

 private:
  struct Fetched {
    Open open;
    std::string slot;
    std::uint64_t shown = 0;  ///< edge at which it came to the head; 0: not yet
    std::uint64_t rows = 0, stalls = 0;
  };

  void drop() {
    for (Fetched& f : fetched_) end(f.open, "dropped");
    fetched_.clear();
    half_.reset();
  }
  void fetch() {
    if (!taken_.on()) return;
    if (!half_) {
      half_ = begin("a secondary");
      field(half_->t, "pass", pass());
    }
    if (!requested_.on()) return;  // a secondary of two beats
    fetched_.push_back({std::move(*half_), number_.decimal()});
    half_.reset();
  }
  void follow_head() {
    if (fetched_.empty()) {  // requested before the file begins
      fetched_.push_back({begin(), ""});
      field(fetched_.back().open.t, "pass", pass());
    }
    Fetched& f = fetched_.front();
    if (f.shown == 0) f.shown = edges_;
    if (issue_.bits.find('1') != std::string::npos) ++f.rows;
    if (stall_.on()) ++f.stalls;
    if (!pop_.on()) return;
    Transaction& t = f.open.t;
    const std::string index = index_.decimal();
    t.stalls = f.stalls;
    field(t, "index", index);
    if (!f.slot.empty()) {
      field(t, "slot", f.slot);
      field(t, "fetch", f.shown - f.open.edge);
    }
    field(t, "rows", f.rows);
    std::string operand;
    if (const auto format = format_of(exp_, man_)) {
      operand = numbers(slot_, *format);
      field(t, "operand", operand);
    }
    t.label = fmt::format("secondary {}{}{}", index, operand.empty() ? "" : " ", operand);
    end(f.open, bad_.on() ? "bad" : "good");
    fetched_.pop_front();
  }

  const Wire &pop_, &valid_, &start_, &done_, &flush_, &issue_, &stall_, &taken_, &requested_,
      &number_, &index_, &bad_, &exp_, &man_;
  std::vector<const Wire*> slot_;
  std::optional<Open> half_;
  std::deque<Fetched> fetched_;
};

}  // namespace

std::unique_ptr<Decoder> engine_decoder(const SignalPlace& place, Decoder::Take take) {
  if (place.of->kind == "pass") return std::make_unique<PassDecoder>(place, std::move(take));
  if (place.of->kind == "primary") return std::make_unique<PrimaryDecoder>(place, std::move(take));
  if (place.of->kind == "secondary")
    return std::make_unique<SecondaryDecoder>(place, std::move(take));
  return nullptr;
}

}  // namespace cde::wave
