// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string_view>

#include "sample.hpp"

namespace cde::testing {
namespace {

/// The wires in a cycle: each letter is an asserted signal.
class Bus {
 public:
  explicit Bus(const std::filesystem::path& file) : w_(file) {
    w_.scope("card");
    w_.scope("bridge");
    clk_ = w_.signal("clk", 1);
    for (std::size_t i = 0; i < kNames.size(); ++i) wires_[i] = w_.signal(kNames[i], 1);
    cbe_ = w_.signal("cbe_n [7:0]", 8);
    ad_ = w_.signal("ad [63:0]", 64);
    own_ = w_.signal("own", 1);
    w_.up();
    w_.up();
    clock("");
  }

  /// F FRAME#, I IRDY#, T TRDY#, S STOP#, D DEVSEL#, Q REQ64#, A ACK64#, P PERR#. They change at
  /// the falling clock edge, for registers that sample them at the rising edge.
  void clock(std::string_view asserted, bool own = false, unsigned cbe = 0, std::uint64_t ad = 0) {
    constexpr std::string_view kLetters = "FITSDQAP";
    w_.time(30ull * cycles_);
    w_.set(clk_, 0);
    for (std::size_t i = 0; i < kLetters.size(); ++i)
      w_.set(wires_[i], asserted.find(kLetters[i]) == std::string_view::npos);
    w_.set(cbe_, cbe);
    w_.set(ad_, ad);
    w_.set(own_, own);
    w_.time(30ull * cycles_ + 15);
    w_.set(clk_, 1);
    ++cycles_;
  }

 private:
  static constexpr std::array<const char*, 8> kNames = {"frame_n",  "irdy_n",  "trdy_n",  "stop_n",
                                                        "devsel_n", "req64_n", "ack64_n", "perr_n"};
  Writer w_;
  fstHandle clk_ = 0, cbe_ = 0, ad_ = 0, own_ = 0;
  std::array<fstHandle, 8> wires_{};
  unsigned cycles_ = 0;
};

}  // namespace

void write_pci(const std::filesystem::path& file) {
  Bus bus(file);
  // A write of three 32-bit words; the target waits one cycle before the second.
  bus.clock("F", false, 7, 0xf0001000);
  for (const char* c : {"FI", "FITD", "FID", "FITD", "ITD", ""}) bus.clock(c);
  // A retried read.
  bus.clock("F", false, 6, 0xf0000030);
  for (const char* c : {"FI", "FISD", "ISD", ""}) bus.clock(c);
  // The card reads 64-bit words; the target stops with the second word.
  bus.clock("FQ", true, 0xe, 0x2000);
  for (const char* c : {"FIQ", "FITDQA", "FITSDQA", "ISDA"}) bus.clock(c, true);
  bus.clock("");
  // A target that deasserts DEVSEL#.
  bus.clock("F", false, 7, 0xf0004000);
  for (const char* c : {"FI", "FID", "FIS", "IS", ""}) bus.clock(c);
  // No target answers.
  bus.clock("FQ", true, 7, 0x3000);
  for (const char* c : {"FIQ", "FIQ", "FIQ", "FIQ", "I"}) bus.clock(c, true);
  bus.clock("");
  // PERR# comes two cycles after its word.
  bus.clock("FQ", true, 7, 0x4000);
  for (const char* c : {"FIQ", "FITDQA", "ITDA"}) bus.clock(c, true);
  for (const char* c : {"", "P", ""}) bus.clock(c);
  // The last word comes with STOP#, which is legal.
  bus.clock("F", false, 0xa, 0x10);
  for (const char* c : {"I", "ID", "ITSD", ""}) bus.clock(c);
  bus.clock("F", false, 6, 0xf0000058);
  bus.clock("FI");
}

}  // namespace cde::testing
