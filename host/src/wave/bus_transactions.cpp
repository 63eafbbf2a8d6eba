// SPDX-License-Identifier: Apache-2.0
// Decodes transactions of a card's buses: PCI, the local bus, and DMA descriptors.
#include <fmt/format.h>

#include <array>
#include <deque>

#include "cde/contract/pci.hpp"
#include "cde/wave/decoder.hpp"

namespace cde::wave {
namespace {

struct PciCycle {
  Open open;
  std::uint64_t words = 0, bytes = 0, waits = 0, first = 0;
  std::uint64_t last = 0, last_edge = 0;  ///< time and number of its last clock
  bool answered = false, wide_asked = false, wide = false, stopped = false, wanted_more = false,
       target_abort = false, parity = false;
};

/// Decodes PCI 2.3. The address phase is the first clock with FRAME#. Data move in cycles with
/// IRDY# and TRDY#. A target ends the transaction with STOP#, and aborts it without DEVSEL#. The
/// last data phase has no FRAME#.
class PciDecoder : public Decoder {
 public:
  PciDecoder(const SignalPlace& place, Take take)
      : Decoder(place, std::move(take)),
        frame_n_(wire("frame_n")),
        irdy_n_(wire("irdy_n")),
        trdy_n_(wire("trdy_n")),
        stop_n_(wire("stop_n")),
        devsel_n_(wire("devsel_n")),
        req64_n_(wire("req64_n")),
        ack64_n_(wire("ack64_n")),
        perr_n_(wire("perr_n")),
        cbe_n_(wire("cbe_n")),
        ad_(wire("ad")),
        own_(wire("own")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (ended_) return ended_->open.t.begin;
    if (now_it_is_) return now_it_is_->open.t.begin;
    return std::nullopt;
  }
  void finish(std::uint64_t time) override {
    if (ended_) tell();
    if (!now_it_is_) return;
    describe(*now_it_is_);
    leave_open(now_it_is_->open, time);
    now_it_is_.reset();
  }

 protected:
  void at_edge(unsigned) override {
    const bool frame = frame_n_.off(), irdy = irdy_n_.off();
    // PERR# comes two cycles after its data, when the transaction may be over.
    if (ended_ && (perr_n_.off() || edges_ >= ended_->last_edge + 2)) {
      if (perr_n_.off() && !(now_it_is_ && now_it_is_->words > 0)) ended_->parity = true;
      tell();
    } else if (perr_n_.off() && now_it_is_ && now_it_is_->words > 0) {
      now_it_is_->parity = true;
    }
    if (now_it_is_ && ((!frame && !irdy) || (frame && !was_frame_))) over();
    if (!now_it_is_) {
      if (frame && !was_frame_) address();
    } else {
      data(frame, irdy);
    }
    was_frame_ = frame;
  }

 private:
  void address() {
    if (ended_) tell();
    PciCycle& c = now_it_is_.emplace();
    c.open = begin();
    c.last = now_;
    c.last_edge = edges_;
    c.wide_asked = req64_n_.off();
    static constexpr std::array<const char*, 16> kCommands = {"interrupt-acknowledge",
                                                              "special",
                                                              "io-read",
                                                              "io-write",
                                                              "reserved",
                                                              "reserved",
                                                              "memory-read",
                                                              "memory-write",
                                                              "reserved",
                                                              "reserved",
                                                              "config-read",
                                                              "config-write",
                                                              "memory-read-multiple",
                                                              "dual-address",
                                                              "memory-read-line",
                                                              "memory-write-invalidate"};
    const auto cbe = cbe_n_.number();
    const auto ad = ad_.number();
    field(c.open.t, "master", own_.on() ? "card" : "host");
    field(c.open.t, "access", !cbe ? "x" : (*cbe & 1) != 0 && (*cbe & 15) != 13 ? "write" : "read");
    field(c.open.t, "command", cbe ? kCommands[*cbe & 15] : "x");
    field(c.open.t, "address", ad ? fmt::format("0x{:08x}", *ad & 0xffffffff) : "x");
  }

  void data(bool frame, bool irdy) {
    PciCycle& c = *now_it_is_;
    const bool devsel = devsel_n_.off(), trdy = trdy_n_.off(), stop = stop_n_.off();
    c.last = now_;
    c.last_edge = edges_;
    if (devsel && !c.answered) c.wide = c.wide_asked && ack64_n_.off();
    c.answered = c.answered || devsel;
    const bool moves = irdy && trdy && devsel;
    if (moves) {
      if (c.words == 0) c.first = edges_ - c.open.edge;
      ++c.words;
      c.bytes += c.wide ? 8 : 4;
    } else {
      ++c.waits;
    }
    if (stop && !c.stopped) {
      c.stopped = true;
      // STOP# at the last data phase takes nothing from the master.
      c.wanted_more = frame || !moves;
      c.target_abort = !devsel;
    }
    if (!frame && irdy && (trdy || stop)) over();
  }

  static std::string outcome(const PciCycle& c) {
    if (c.parity) return "parity";
    if (!c.answered) return "master-abort";
    if (c.target_abort) return "target-abort";
    if (c.stopped && c.words == 0) return "retry";
    return c.stopped && c.wanted_more ? "disconnect" : "done";
  }
  static void describe(PciCycle& c) {
    Transaction& t = c.open.t;
    const std::string width = c.wide ? "64" : "32";
    field(t, "words", c.words);
    field(t, "width", width);
    field(t, "bytes", c.bytes);
    if (c.words != 0) field(t, "first_word", c.first);
    field(t, "stop", c.stopped ? 1 : 0);
    t.stalls = c.waits;
    t.label = fmt::format("{} {} {}, {} word{} of {} bits", t.fields[0].second, t.fields[2].second,
                          t.fields[3].second, c.words, c.words == 1 ? "" : "s", width);
  }
  void over() {
    ended_ = std::move(now_it_is_);
    now_it_is_.reset();
  }
  /// Reports the transaction, which ended at an earlier edge.
  void tell() {
    PciCycle c = std::move(*ended_);
    ended_.reset();
    describe(c);
    end_at(c.open, outcome(c), c.last, c.last_edge);
  }

  const Wire &frame_n_, &irdy_n_, &trdy_n_, &stop_n_, &devsel_n_, &req64_n_, &ack64_n_, &perr_n_,
      &cbe_n_, &ad_, &own_;
  std::optional<PciCycle> now_it_is_, ended_;
  bool was_frame_ = false;
};

/// Decodes beats of 64 bits. Consecutive beats of a memory in one direction, at most two cycles
/// apart, are one access. A register beat is an access of its own. A later cycle serves a beat, and
/// may refuse it.
class LocalBusDecoder : public Decoder {
 public:
  LocalBusDecoder(const SignalPlace& place, Take take)
      : Decoder(place, std::move(take)),
        valid_(wire("bus_i.valid")),
        write_(wire("bus_i.write")),
        space_(wire("bus_i.space")),
        addr_(wire("bus_i.addr")),
        ready_(wire("bus_o.ready")),
        rvalid_(wire("bus_o.rvalid")),
        serving_(wire("valid_q")),
        serves_(wire("ready")),
        allowed_(wire("allowed")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (open_.empty()) return std::nullopt;
    return open_.front().open.t.begin;
  }
  void finish(std::uint64_t time) override {
    for (Access& a : open_) {
      describe(a);
      if (done(a))
        close(a);
      else
        leave_open(a.open, time);
    }
    open_.clear();
  }

 protected:
  void at_edge(unsigned) override {
    if (rvalid_.on()) note(&Access::answered);
    if (serving_.on() && serves_.on()) {
      if (!allowed_.on())
        for (Access& a : open_)
          if (a.served < a.words) {
            a.refused = true;
            break;
          }
      note(&Access::served);
    }
    if (!valid_.on()) {
      if (++gap_ > 2) growing_ = false;
    } else {
      gap_ = 0;
      if (!growing_ || !follows()) start();
      Access& a = open_.back();
      if (ready_.on()) {
        ++a.words;
        a.last = now_;
        a.last_edge = edges_;
        a.next = addr_.number().value_or(0) + 8;
      } else {
        ++a.stalls;
      }
    }
    while (!open_.empty() && done(open_.front()) && !(growing_ && open_.size() == 1)) {
      describe(open_.front());
      close(open_.front());
      open_.pop_front();
    }
  }

 private:
  struct Access {
    Open open;
    bool write = false, refused = false;
    std::string space;
    std::uint64_t words = 0, served = 0, answered = 0, stalls = 0, next = 0;
    std::uint64_t last = 0, last_edge = 0;
  };

  static bool done(const Access& a) {
    return a.words != 0 && a.served >= a.words && (a.write || a.answered >= a.words);
  }
  /// Notes an answer or a served beat for the oldest access that waits for one.
  void note(std::uint64_t Access::*what) {
    for (Access& a : open_) {
      if ((what == &Access::answered && a.write) || a.*what >= a.words) continue;
      ++(a.*what);
      a.last = now_;
      a.last_edge = edges_;
      return;
    }
  }
  [[nodiscard]] bool follows() const {
    const Access& a = open_.back();
    if (a.write != write_.on() || a.space != space_.bits) return false;
    if (a.words == 0) return true;
    // A read of the record memory takes the next record at any address.
    const auto address = addr_.number();
    return space_.number() != 0 && (address == a.next || (address && *address + 8 == a.next));
  }
  void start() {
    Access& a = open_.emplace_back();
    a.open = begin();
    a.write = write_.on();
    a.space = space_.bits;
    growing_ = true;
    field(a.open.t, "access", a.write ? "write" : "read");
    field(a.open.t, "space", space_name(space_));
    field(a.open.t, "address", addr_.hexadecimal());
  }
  static void describe(Access& a) {
    Transaction& t = a.open.t;
    t.stalls = a.stalls;
    field(t, "words", a.words);
    field(t, "bytes", a.words * 8);
    t.label = fmt::format("{} {} {}, {} word{}", t.fields[0].second, t.fields[1].second,
                          t.fields[2].second, a.words, a.words == 1 ? "" : "s");
  }
  void close(Access& a) { end_at(a.open, a.refused ? "refused" : "done", a.last, a.last_edge); }

  const Wire &valid_, &write_, &space_, &addr_, &ready_, &rvalid_, &serving_, &serves_, &allowed_;
  std::deque<Access> open_;  ///< oldest first; only the last one grows
  unsigned gap_ = 0;         ///< cycles without a beat
  bool growing_ = false;
};

class DmaDecoder : public Decoder {
 public:
  DmaDecoder(const SignalPlace& place, Take take)
      : Decoder(place, std::move(take)),
        fetched_(wire("fetched_q")),
        busy_(wire("busy_o")),
        moving_(wire("start_o")),
        purpose_(wire("purpose_q")),
        head_(wire("head_q")),
        host_(wire("host_q")),
        bytes_(wire("bytes_q")),
        remaining_(wire("remaining_q")),
        offset_(wire("offset_q")),
        space_(wire("space_q")),
        to_host_(wire("to_host_q")),
        irq_(wire("irq_q")),
        code_(wire("code_q")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (!open_) return std::nullopt;
    return open_->t.begin;
  }
  void finish(std::uint64_t time) override {
    if (!open_) return;
    if (!busy_.on()) {  // its clock has stopped
      tell();
      return;
    }
    describe();
    leave_open(*open_, time);
    open_.reset();
  }

 protected:
  void at_edge(unsigned) override {
    if (open_ && !busy_.on()) tell();
    if (!busy_.on()) return;
    if (!open_) {
      open_ = begin();
      number_ = head_.decimal();
      bursts_ = stalls_ = 0;
      was_moving_ = known_ = false;
    }
    if (moving_.on()) {
      if (!was_moving_ && purpose_.number() == pci::kWhereData) ++bursts_;
    } else {
      ++stalls_;
    }
    was_moving_ = moving_.on();
    last_ = now_;
    last_edge_ = edges_;
    known_ = known_ || fetched_.number().value_or(0) >= 2 || bytes_.number().value_or(0) != 0;
    code_then_ = code_.number().value_or(0);
    moved_ = bytes_.number().value_or(0) - remaining_.number().value_or(0);
  }

 private:
  static std::string outcome(std::uint64_t code) {
    constexpr std::array<const char*, 12> kCodes = {
        "done",         "length", "alignment",   "unmapped", "read-only", "master-abort",
        "target-abort", "parity", "retry-limit", "settings", "stopped",   "disabled"};
    return code < kCodes.size() ? kCodes[code] : fmt::format("code-{}", code);
  }
  void describe() {
    Transaction& t = open_->t;
    const bool to_host = to_host_.on();
    t.stalls = stalls_;
    field(t, "descriptor", number_);
    if (!known_) {
      t.label = fmt::format("descriptor {}", number_);
      return;
    }
    field(t, "direction", to_host ? "to-host" : "to-card");
    field(t, "host", host_.hexadecimal());
    field(t, "space", space_name(space_));
    field(t, "offset", offset_.hexadecimal());
    field(t, "bytes", bytes_.decimal());
    field(t, "moved", moved_);
    field(t, "bursts", bursts_);
    field(t, "interrupt", irq_.on() ? "1" : "0");
    const std::string memory = fmt::format("{} {}", space_name(space_), offset_.hexadecimal());
    t.label = fmt::format("descriptor {}: {} bytes from {} to {}", number_, bytes_.decimal(),
                          to_host ? memory : "the host", to_host ? "the host" : memory);
  }
  void tell() {
    describe();
    end_at(*open_, outcome(code_then_), last_, last_edge_);
    open_.reset();
  }

  const Wire &fetched_, &busy_, &moving_, &purpose_, &head_, &host_, &bytes_, &remaining_, &offset_,
      &space_, &to_host_, &irq_, &code_;
  std::optional<Open> open_;
  std::string number_;
  std::uint64_t bursts_ = 0, stalls_ = 0, moved_ = 0, code_then_ = 0, last_ = 0, last_edge_ = 0;
  bool was_moving_ = false, known_ = false;
};

}  // namespace

std::unique_ptr<Decoder> bus_decoder(const SignalPlace& place, Decoder::Take take) {
  if (place.of->kind == "pci") return std::make_unique<PciDecoder>(place, std::move(take));
  if (place.of->kind == "dma") return std::make_unique<DmaDecoder>(place, std::move(take));
  if (place.of->kind == "bus") return std::make_unique<LocalBusDecoder>(place, std::move(take));
  return nullptr;
}

}  // namespace cde::wave
