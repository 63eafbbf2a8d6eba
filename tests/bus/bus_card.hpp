// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "cde/abi/abi_pci.h"
#include "cde/contract/pci.hpp"
#include "cde/contract/registers.hpp"
#include "cde/model/model.hpp"

/// GoogleTest prints a code by its name.
namespace cde::pci {
void PrintTo(Code code, std::ostream* out);
void PrintTo(Where where, std::ostream* out);
}  // namespace cde::pci

namespace cde::testing {

/// A host profile by name; docs/reference/pci.md lists the sources of its figures.
cde_pci_profile profile(const std::string& name);

struct BusOptions {
  std::string kind = "pci_bridge";
  std::vector<std::string> parameters = {};
  std::string profile = "ideal";
  bool narrow = false;  ///< a 32-bit host
  std::uint32_t core_period_ps = 10'000;
  std::uint64_t memory_bytes = 16 << 20;
  std::uint64_t seed = 1;
};

/// Code of a Result if no record arrived in time.
inline constexpr auto kNoRecord = static_cast<pci::Code>(~0u);

/// A completion record that the driver reads.
struct Result {
  unsigned number = 0;
  pci::Code code = pci::kCodeOk;
  std::uint32_t bytes = 0;
  std::uint32_t fault = 0;
  std::uint16_t pci_status = 0;
};

/// Result of a host access, CDE_PCI_*; printed by name.
struct Ending {
  int code;
  friend bool operator==(Ending a, int code) { return a.code == code; }
  friend void PrintTo(Ending a, std::ostream* out);
};

/// Success, or the position of the first difference.
::testing::AssertionResult same_bytes(std::span<const std::uint8_t> got,
                                      std::span<const std::uint8_t> wanted);

/// An enumerated card in its host with a descriptor ring, in the state that a minimal driver sets
/// up. By default host pages are mapped one to one: entry n of the page table is page n of host
/// memory. Descriptors and completion records lie in the first two pages. A violated bus rule fails
/// the test.
class BusCard {
 public:
  static constexpr std::uint32_t kBar = 0xF0000000;
  static constexpr std::uint32_t kRingPage = 0, kCompletionPage = 1, kFirstFree = 2;

  explicit BusCard(const BusOptions& options = {});
  BusCard(const BusCard&) = delete;
  BusCard& operator=(const BusCard&) = delete;
  ~BusCard();

  const cde_pci_api& api() const { return *api_; }
  void* handle() const { return handle_; }

  /// Places BAR0, enables memory, mastering and parity reports, and sets the latency timer.
  void enumerate(std::uint32_t command = 0x146, std::uint8_t latency_timer = 64);
  std::uint32_t config(std::uint32_t offset) const;
  void set_config(std::uint32_t offset, std::uint32_t value) const;

  std::uint64_t read(std::uint32_t offset) const;
  void write(std::uint32_t offset, std::uint64_t value) const;
  std::uint32_t read32(std::uint32_t offset) const;
  void write32(std::uint32_t offset, std::uint32_t value) const;
  Ending transact(cde_pci_transaction& t) const { return {api_->transact(handle_, &t)}; }
  /// Lets time pass, with or without interrupts.
  void pass(std::uint64_t ps) const { api_->run(handle_, ps, 0); }
  cde_pci_counters counters() const;
  void fault(std::uint32_t kind, std::uint32_t count, std::uint32_t value = 0) const;

  /// Sets a page-table entry: its page and its flags.
  void map(std::uint32_t entry, std::uint32_t page, bool writable = true, bool valid = true) const;
  /// Maps entries `first` to `last` one to one, in bursts.
  void map_range(std::uint32_t first, std::uint32_t last) const;
  /// Writes host memory at a one-to-one mapped address, page by page.
  void put(std::uint32_t mapped, std::span<const std::uint8_t> bytes) const;
  std::vector<std::uint8_t> get(std::uint32_t mapped, std::uint32_t bytes) const;
  std::span<std::uint8_t> local(card::Space space) const;

  /// Starts a ring of `size` descriptors in the first page, with interrupts for completions and
  /// halts.
  void start_ring(unsigned size = 16, std::uint32_t burst = 4096);
  void submit(const pci::Descriptor& descriptor);  ///< stages a descriptor and publishes the tail
  void stage(const pci::Descriptor& descriptor);   ///< into the ring only
  void publish() const;                            ///< writes the tail register
  /// The next record, or kNoRecord after a timeout in microseconds.
  Result wait(double microseconds = 20'000);
  Result transfer(std::uint32_t mapped, std::uint32_t bytes, card::Space space,
                  std::uint32_t offset, bool to_host) {
    submit(descriptor(mapped, bytes, space, offset, to_host));
    return wait();
  }
  void clear();  ///< after a halt: empty ring, still set up, not running
  static pci::Descriptor descriptor(std::uint32_t mapped, std::uint32_t bytes, card::Space space,
                                    std::uint32_t offset, bool to_host, bool irq = true);
  pci::Code status_code() const;  ///< reason why the ring halted
  pci::Where status_where() const;
  bool halted() const { return (read(pci::kRegStatus) >> pci::kStatusHalted & 1) != 0; }

 private:
  SimulationModel model_;
  const cde_pci_api* api_;
  void* handle_;
  unsigned size_ = 0, tail_ = 0, next_ = 0;
  bool lap_ = true;
};

/// Random numbers that are the same on every platform.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t bits() { return engine_(); }
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(std::uint64_t{bits()} * n >> 32);
  }
  std::vector<std::uint8_t> bytes(std::size_t n) {
    std::vector<std::uint8_t> v(n);
    for (auto& b : v) b = static_cast<std::uint8_t>(bits() >> 24);
    return v;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace cde::testing
