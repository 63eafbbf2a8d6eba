// SPDX-License-Identifier: Apache-2.0
// A card in its host: the Verilated model, whose top has the ports of pci_bridge.sv, the host on
// the same wires, the protocol checker, and both clocks in picoseconds. `Local` supplies the other
// inputs of the model's core side (chips, or a memory on the local bus).
#pragma once
#include <algorithm>
#include <memory>

#include "Vmodel.h"
#include "cde/abi/abi_pci.h"
#include "coverage.h"
#include "pci_host.h"
#include "pci_monitor.h"
#include "random_start.h"
#include "verilated.h"
#include "wave_file.h"

namespace pci {

template <class Local>
class Bus {
 public:
  explicit Bus(const cde_pci_options& o, const char* kind)
      : options_(o),
        kind_(kind),
        context_(new VerilatedContext),
        random_(*context_),
        model_(new Vmodel(context_.get(), kind)),
        local_(o),
        host_(o),
        next_pci_(o.pci_period_ps),
        next_core_(o.core_period_ps) {
    random_.before_reset(*model_, [this] {
      for (const int level : {0, 1}) {
        model_->clk_i = level;
        model_->eval();
        model_->clk_pci_i = level;
        model_->eval();
      }
    });
    reset();
    random_.after_reset();
  }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() {
    trace_close();
    // A thread remembers the context that it used last, which may belong to a destroyed card.
    Verilated::threadContextp(context_.get());
    model_->final();
    cde_write_coverage(context_.get(), kind_);
  }

  /// Asserts RST# for four periods of the slower clock, then waits until the card is ready.
  void reset() {
    model_->rst_i = 1;
    host_.reset();
    stuck_ = false;
    monitor_.reset();
    local_.reset();
    card_ = Drive();
    settle();
    run_until(now_ + 5ull * std::max(options_.pci_period_ps, options_.core_period_ps));
    model_->rst_i = 0;
    settle();
    run_until(now_ + options_.pci_period_ps);
    for (const uint64_t limit = patience(); !model_->idle_o && counters_.cycles < limit;) step();
  }

  int transact(cde_pci_transaction& t) {
    if (stuck_) return CDE_PCI_STUCK;
    host_.initiator().start(t);
    const uint64_t limit = patience();
    while (host_.initiator().busy() && counters_.cycles < limit) step();
    stuck_ = host_.initiator().busy();
    if (stuck_) host_.initiator().abandon();
    return stuck_ ? int{CDE_PCI_STUCK} : host_.initiator().result();
  }

  /// One access of the CPU, repeated until all of it is done.
  int access(uint8_t command, uint32_t address, uint32_t* data, uint32_t dwords) {
    const uint64_t limit = patience();
    for (uint32_t at = 0; at < dwords;) {
      cde_pci_transaction t{};
      t.command = command;
      t.address = address + 4 * at;
      t.dwords = std::min<uint32_t>(dwords - at, 64);
      t.wide = options_.narrow == 0 && (t.address & 7) == 0 && t.dwords % 2 == 0 &&
               command < kConfigRead;
      std::copy_n(data + at, t.dwords, t.data);
      std::fill_n(t.enable, t.dwords, uint8_t{0xF});
      if (const int result = transact(t); result != CDE_PCI_OK) return result;
      if (!is_write(command)) std::copy_n(t.data, t.done, data + at);
      at += t.done;
      if (counters_.cycles >= limit) return CDE_PCI_RETRIED;
    }
    return CDE_PCI_OK;
  }

  int config_read(uint32_t offset, uint32_t& value) {
    return access(kConfigRead, offset & 0xFC, &value, 1);
  }
  int config_write(uint32_t offset, uint32_t value) {
    const int result = access(kConfigWrite, offset & 0xFC, &value, 1);
    if (result == CDE_PCI_OK && (offset & 0xFC) == kBar0) base_ = value & ~0xFFFFu;
    return result;
  }
  int mmio(uint8_t command, uint32_t offset, uint32_t* data, uint32_t bytes) {
    return access(command, base_ + offset, data, bytes / 4);
  }

  uint64_t run(uint64_t max_ps, bool until_interrupt) {
    const uint64_t start = now_;
    const uint64_t end = now_ + max_ps;
    const auto seen = [&] { return until_interrupt && interrupt(); };
    while (!seen() && std::min(next_pci_, next_core_) <= end) step();
    if (!seen()) now_ = end;
    return now_ - start;
  }
  [[nodiscard]] bool interrupt() const { return interrupt_ && !interrupt_lost_; }
  [[nodiscard]] uint64_t time_ps() const { return now_; }

  [[nodiscard]] cde_pci_counters counters() const {
    cde_pci_counters c = counters_;
    c.waits = c.busy - c.data;
    c.bytes_read = host_.target().bytes_read();
    c.bytes_written = host_.target().bytes_written();
    c.transactions = host_.target().transactions();
    std::copy_n(host_.faults().taken(), CDE_PCI_FAULTS, c.faults);
    c.faults[CDE_PCI_FAULT_HANG] = local_.hung();
    return c;
  }
  [[nodiscard]] const char* violation() const {
    return monitor_.violation().empty() ? nullptr : monitor_.violation().c_str();
  }
  Host& host() { return host_; }
  Local& local() { return local_; }
  void evaluate_all(bool on) { evaluate_all_ = on; }

  int trace_open(const cde_trace& what) { return waves_.open(*context_, *model_, what, now_); }
  int trace_close() { return waves_.close(); }

 private:
  static constexpr uint32_t kBar0 = 0x10;
  /// In waves, the time of a PCI clock edge before a simultaneous core clock edge. It leaves room
  /// for both falling edges.
  static constexpr uint64_t kBeforeCore = 4;

  /// The clock at which an access that begins now is given up.
  [[nodiscard]] uint64_t patience() const { return counters_.cycles + 1'000'000; }

  /// Runs the next edge; on a tie the PCI clock's.
  void step() {
    if (next_pci_ <= next_core_) {
      now_ = next_pci_;
      next_pci_ += options_.pci_period_ps;
      pci_edge();
    } else {
      now_ = next_core_;
      next_core_ += options_.core_period_ps;
      core_edge();
    }
  }
  void run_until(uint64_t end) {
    while (std::min(next_pci_, next_core_) <= end) step();
  }

  void core_edge() {
    local_.before(*model_);
    model_->clk_i = 0;
    eval(std::max(now_ - options_.core_period_ps / 2, between(last_wave_, now_)));
    local_.at(*model_);
    model_->clk_i = 1;
    eval(now_);
    local_.after(*model_);
  }

  void pci_edge() {
    ++counters_.cycles;
    if (!evaluate_all_ && !model_->rst_i && model_->idle_o && host_.idle() &&
        wires_.inta == interrupt_) {
      ++counters_.skipped;
      monitor_.idle_clock();
      return;
    }
    const Wires w = wires_;
    if (!model_->rst_i) {
      monitor_.clock(host_.drive(), card_, w, host_.grant(), host_.grant_card(), host_.spoilt());
      counters_.busy += !w.idle();
      counters_.data += w.asserted(kIrdy) && w.asserted(kTrdy);
      host_.clock(w, card_.request);
      if (w.inta != interrupt_) see_interrupt(w.inta);
    }
    model_->clk_pci_i = 1;
    eval(next_core_ == now_ ? now_ - kBeforeCore : now_);
    settle();
  }

  void see_interrupt(bool on) {
    uint32_t unused = 0;
    interrupt_ = on;
    interrupt_lost_ = on && host_.faults().take(CDE_PCI_FAULT_LOST_INTERRUPT, unused);
  }

  /// Reads what the card drives, and computes the wires and grants that it samples at the next
  /// edge.
  void settle() {
    card_ = read_drive();
    wires_ = resolve(host_.drive(), card_);
    const auto high = [this](Signal s) { return (wires_.high & s) != 0; };
    model_->pci_ad_i = wires_.ad ^ host_.misheard();
    model_->pci_cbe_n_i = wires_.cbe;
    model_->pci_par_i = high(kPar);
    model_->pci_par64_i = high(kPar64);
    model_->pci_frame_n_i = high(kFrame);
    model_->pci_req64_n_i = high(kReq64);
    model_->pci_irdy_n_i = high(kIrdy);
    model_->pci_trdy_n_i = high(kTrdy);
    model_->pci_stop_n_i = high(kStop);
    model_->pci_devsel_n_i = high(kDevsel);
    model_->pci_ack64_n_i = high(kAck64);
    model_->pci_perr_n_i = high(kPerr);
    model_->pci_idsel_i = host_.idsel();
    model_->pci_gnt_n_i = !host_.grant_card();
    model_->clk_pci_i = 0;
    eval(std::min(now_ + options_.pci_period_ps / 2, between(last_wave_, next_core_)));
  }

  Drive read_drive() const {
    Drive d;
    const Vmodel& m = *model_;
    const auto put = [&d](Signal s, bool enable, bool high) {
      if (enable) d.enable |= s;
      if (!high) d.high &= ~uint32_t{s};
    };
    d.ad = m.pci_ad_o;
    d.cbe = m.pci_cbe_n_o;
    put(kAd, m.pci_ad_oe, true);
    put(kAd64, m.pci_ad64_oe, true);
    put(kCbe, m.pci_cbe_oe, true);
    put(kPar, m.pci_par_oe, m.pci_par_o);
    put(kPar64, m.pci_par64_oe, m.pci_par64_o);
    put(kFrame, m.pci_frame_oe, m.pci_frame_n_o);
    put(kReq64, m.pci_req64_oe, m.pci_req64_n_o);
    put(kIrdy, m.pci_irdy_oe, m.pci_irdy_n_o);
    put(kTrdy, m.pci_trdy_oe, m.pci_trdy_n_o);
    put(kStop, m.pci_stop_oe, m.pci_stop_n_o);
    put(kDevsel, m.pci_devsel_oe, m.pci_devsel_n_o);
    put(kAck64, m.pci_ack64_oe, m.pci_ack64_n_o);
    put(kPerr, m.pci_perr_oe, m.pci_perr_n_o);
    d.request = !m.pci_req_n_o;
    d.serr = m.pci_serr_oe;
    d.inta = m.pci_inta_oe;
    return d;
  }

  static uint64_t between(uint64_t a, uint64_t b) { return b > a ? a + (b - a) / 2 : a; }

  /// Evaluates the model. Waves have rising edges at their exact times. Falling edges are evaluated
  /// just after or before them, and lie somewhere between the rising edges: the writer drops times
  /// that do not increase.
  void eval(uint64_t wave_time) {
    model_->eval();
    last_wave_ = std::max(wave_time, last_wave_ + 1);
    if (Local::asks(*model_, waves_.awaited_word())) waves_.begin(last_wave_);
    waves_.dump(last_wave_);
  }

  const cde_pci_options options_;
  const char* kind_;
  std::unique_ptr<VerilatedContext> context_;
  RandomStart random_;
  std::unique_ptr<Vmodel> model_;
  WaveFile waves_;
  Local local_;
  Host host_;
  Monitor monitor_;
  Drive card_;
  Wires wires_;
  cde_pci_counters counters_{};
  uint64_t now_ = 0, next_pci_, next_core_, last_wave_ = 0;
  uint32_t base_ = 0;
  bool interrupt_ = false, interrupt_lost_ = false, evaluate_all_ = false, stuck_ = false;
};

}  // namespace pci
