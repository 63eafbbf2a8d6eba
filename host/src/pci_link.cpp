// A card behind PCI: what a kernel driver does with it.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "abi_pci.h"
#include "card_link.hpp"
#include "cde/error.hpp"
#include "cde/pci.hpp"

namespace cde {
namespace {

constexpr std::uint32_t kBar =
    0xF0000000;                            // where the card's registers lie in the host's addresses
constexpr std::uint32_t kCommand = 0x146;  // memory, bus master, parity, SERR
constexpr std::uint32_t kPageBytes = 1u << pci::kPageBits;
// Pages by their entry in the card's page table: descriptors, completion records, data.
constexpr std::uint32_t kRingPage = 0, kCompletionPage = 1, kDataPage = 2;
constexpr std::uint32_t kDataBytes = kMappedBytes, kDataPages = kDataBytes / kPageBytes;
constexpr unsigned kDescriptors = 16;

const char* text_of(std::uint32_t code) {
  static constexpr const char* kTexts[] = {"ok",
                                           "bad length",
                                           "bad alignment",
                                           "page not mapped",
                                           "read-only page",
                                           "master abort",
                                           "target abort",
                                           "parity error",
                                           "too many retries",
                                           "bad ring settings",
                                           "stopped",
                                           "bus mastering is off"};
  return code < std::size(kTexts) ? kTexts[code] : "unknown code";
}

class PciLink final : public CardLink {
 public:
  PciLink(Bitstream bitstream, const OpenOptions& options)
      : bitstream_(std::move(bitstream)),
        period_ps_(options.clock_period_ps),
        retries_(options.bus_retries),
        burst_(options.bus_burst) {
    api_ = reinterpret_cast<cde_pci_entry_fn>(bitstream_.symbol("cde_pci_entry"))();
    if (api_->abi != CDE_PCI_ABI) {
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("bitstream {}: C interface version {}, this driver speaks {}",
                              bitstream_.path().string(), api_->abi, CDE_PCI_ABI));
    }
    const HostProfile& p = options.host;
    const cde_pci_options card_options = {
        .core_period_ps = period_ps_,
        .pci_period_ps = 15'000,
        .memory = static_cast<std::uint32_t>(options.memory),
        .ddr_latency = options.ddr_latency,
        .narrow = options.narrow_bus ? 1u : 0u,
        .memory_bytes = std::uint64_t{2} * (kDataPage + kDataPages) * kPageBytes,
        .seed = 1,
        .profile = {p.arbitration, p.read_latency, p.write_latency, 0, 0}};
    host_ = api_->create(&card_options);
    if (host_ == nullptr) throw Error(ErrorCode::kDevice, "no memory for the card's models");
    try {
      set_up();
    } catch (...) {
      api_->destroy(host_);
      throw;
    }
  }
  PciLink(const PciLink&) = delete;
  PciLink& operator=(const PciLink&) = delete;
  ~PciLink() override { api_->destroy(host_); }

  void write(card::Space space, std::uint32_t offset, const void* data,
             std::uint64_t beats) override {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    if (is_register(space, offset, beats)) return store(offset, data, 8 * beats);
    for (std::uint64_t done = 0; done < 8 * beats;) {
      const auto n =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(kDataBytes, 8 * beats - done));
      stage(bytes + done, n);
      move(space, offset + static_cast<std::uint32_t>(done), n, false);
      done += n;
      counters_.bytes_to_card += n;
    }
  }

  void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) override {
    auto* bytes = static_cast<std::uint8_t*>(data);
    if (is_register(space, offset, beats)) return fetch(offset, data, 8 * beats);
    for (std::uint64_t done = 0; done < 8 * beats;) {
      const auto n =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(kDataBytes, 8 * beats - done));
      move(space, offset + static_cast<std::uint32_t>(done), n, true);
      unstage(bytes + done, n);
      done += n;
      counters_.bytes_to_host += n;
    }
  }

  /// An interrupt that is lost is found by asking, at intervals that double: late by no more than
  /// the card worked.
  std::uint64_t run(std::uint64_t max_clocks) override {
    alive();
    const std::uint64_t start = time_ps(), end = start + max_clocks * period_ps_;
    for (std::uint64_t slice = kFirstAskClocks * period_ps_; !pending_ && time_ps() < end;
         slice *= 2) {
      api_->run(host_, std::min(slice, end - time_ps()), 1);
      if (api_->interrupt(host_) != 0) break;
      if ((load(pci::kRegIrqStatus) >> pci::kIrqCard & 1) != 0) {
        pending_ = true;
        ++counters_.lost_interrupts;
      }
    }
    return (time_ps() - start) / period_ps_;
  }
  bool interrupt() override {
    const bool seen = pending_ || api_->interrupt(host_) != 0;
    pending_ = false;
    return seen;
  }
  [[nodiscard]] std::uint64_t clocks() const override { return time_ps() / period_ps_; }
  [[nodiscard]] std::uint64_t time_ps() const override { return api_->time_ps(host_); }
  [[nodiscard]] BusCounters counters() const override {
    BusCounters c = counters_;
    cde_pci_counters pci{};
    api_->counters(host_, &pci);
    c.pci_clocks = pci.clocks;
    c.pci_busy = pci.busy;
    c.pci_data = pci.data;
    return c;
  }
  [[nodiscard]] MemoryCounters memory_counters() const override {
    cde_memory_counters c{};
    api_->memory_counters(host_, &c);
    return {.bursts = c.bursts, .row_misses = c.row_misses, .refreshes = c.refreshes};
  }
  void reset() override {
    api_->reset(host_);
    lost_ = pending_ = false;
    set_up();
  }
  void inject(BusFault fault, std::uint32_t count, std::uint32_t value) override {
    if (api_->fault(host_, static_cast<std::uint32_t>(fault), count, value) != 0)
      throw Error(ErrorCode::kUsage, "the bus has no such fault");
  }

  void trace_open(const std::filesystem::path& file) override {
    if (std::strstr(api_->parameters, "TRACE=1") == nullptr) {
      throw Error(ErrorCode::kUsage,
                  "this bitstream has no waves; open the board with BoardConfig::trace");
    }
    if (api_->trace_open(host_, file.c_str()) != 0)
      throw Error(ErrorCode::kFile, fmt::format("{}: cannot write waves", file.string()));
  }
  void trace_close() override { api_->trace_close(host_); }
  void flip_ddr(std::uint64_t, std::uint8_t) override {
    throw Error(ErrorCode::kUsage, "no way to flip bits");
  }
  [[nodiscard]] std::uint64_t config_hash() const override { return api_->config_hash; }

 private:
  static bool is_register(card::Space space, std::uint32_t offset, std::uint64_t beats) {
    return space == card::kSpaceReg && offset + 8 * beats <= pci::kRegisters;
  }

  // ---- Set-up ----

  void set_up() {
    std::uint32_t id = 0;
    config(api_->config_read(host_, 0x00, &id), 0x00);
    if (id != (std::uint32_t{pci::kDeviceId} << 16 | pci::kVendorId))
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("PCI device {:08x} is no card of cde", id));
    config(api_->config_write(host_, 0x10, kBar), 0x10);
    config(api_->config_write(host_, 0x0C, 0x4008), 0x0C);  // latency timer, line size
    config(api_->config_write(host_, 0x04, kCommand), 0x04);
    while ((load(pci::kRegStatus) >> pci::kStatusClearing & 1) != 0) {
    }
    std::vector<std::uint64_t> entries;
    for (std::uint32_t page = 0; page < kDataPage + kDataPages; ++page) {
      const bool writable = page != kRingPage;
      entries.push_back(std::uint64_t{api_->frame(host_, page)} << pci::kPageFrame |
                        1u << pci::kPageValid |
                        static_cast<std::uint64_t>(writable) << pci::kPageWritable);
    }
    store(pci::kPageTable, entries.data(), 8 * entries.size());
    set(pci::kRegBurst, burst_);
    set(pci::kRegRetryLimit, 1u << 16);
    set(pci::kRegRingBase, kRingPage * kPageBytes);
    set(pci::kRegRingSize, kDescriptors);
    set(pci::kRegCompletionBase, kCompletionPage * kPageBytes);
    start_ring();
  }
  void start_ring() {
    std::memset(page(kCompletionPage), 0, kDescriptors * pci::kCompletionBytes);
    set(pci::kRegControl, 1u << pci::kControlClear);
    set(pci::kRegRingTail, 0);
    set(pci::kRegIrqStatus, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    set(pci::kRegIrqMask, 1u << pci::kIrqCard);
    set(pci::kRegControl, 1u << pci::kControlRun);
    next_ = 0;
    lap_ = true;
  }
  void config(int status, std::uint32_t offset) { accessed(status, offset, "configuration space"); }

  // ---- Registers ----

  void store(std::uint32_t offset, const void* data, std::uint64_t bytes) {
    access([&] { return api_->mmio_write(host_, offset, data, static_cast<std::uint32_t>(bytes)); },
           offset);
  }
  void fetch(std::uint32_t offset, void* data, std::uint64_t bytes) {
    access([&] { return api_->mmio_read(host_, offset, data, static_cast<std::uint32_t>(bytes)); },
           offset);
  }
  void set(std::uint32_t offset, std::uint64_t value) { store(offset, &value, 8); }
  std::uint64_t load(std::uint32_t offset) {
    std::uint64_t value = 0;
    fetch(offset, &value, 8);
    return value;
  }

  /// Reads have no side effects, and the card drops what is written with bad parity.
  template <class F>
  void access(const F& once, std::uint32_t offset) {
    alive();
    ++counters_.register_accesses;
    int status = once();
    for (unsigned i = 0; status == CDE_PCI_PARITY && i < retries_; ++i) {
      ++counters_.access_retries;
      status = once();
    }
    accessed(status, offset, "register access");
  }
  void accessed(int status, std::uint32_t offset, const char* what) {
    if (status == CDE_PCI_OK) return;
    if (status == CDE_PCI_MASTER_ABORT) {
      lost_ = true;
      lost_clock_ = clocks();
      alive();
    }
    const char* const why = status == CDE_PCI_TARGET_ABORT ? "target abort"
                            : status == CDE_PCI_PARITY     ? "parity error"
                                                           : "nothing but retries";
    fail(fmt::format("{} at offset {:#x}: {}", what, offset, why), {.address = offset});
  }
  void alive() const {
    if (!lost_) return;
    throw Error(ErrorCode::kDevice,
                fmt::format("the card does not answer since clock {}; it is lost until reset()",
                            lost_clock_),
                DeviceFault{.code = pci::kCodeMasterAbort, .clock = lost_clock_});
  }
  [[noreturn]] void fail(const std::string& what, DeviceFault fault) {
    std::uint32_t status = 0;
    (void)api_->config_read(host_, 0x04, &status);
    if (fault.pci_status == 0) fault.pci_status = static_cast<std::uint16_t>(status >> 16);
    fault.clock = clocks();
    throw Error(ErrorCode::kDevice,
                fmt::format("{} (PCI status {:#06x}, address {:#x}, clock {})", what,
                            fault.pci_status, fault.address, fault.clock),
                fault);
  }

  // ---- Host memory ----

  std::uint8_t* page(std::uint32_t entry) {
    return static_cast<std::uint8_t*>(api_->memory(host_, api_->frame(host_, entry)));
  }
  void stage(const std::uint8_t* from, std::uint32_t bytes) {
    for (std::uint32_t at = 0; at < bytes; at += kPageBytes)
      std::memcpy(page(kDataPage + at / kPageBytes), from + at, std::min(kPageBytes, bytes - at));
  }
  void unstage(std::uint8_t* to, std::uint32_t bytes) {
    for (std::uint32_t at = 0; at < bytes; at += kPageBytes)
      std::memcpy(to + at, page(kDataPage + at / kPageBytes), std::min(kPageBytes, bytes - at));
  }

  // ---- Transfers ----

  struct Ending {
    std::uint32_t code, bytes, address;
    std::uint16_t pci_status;
  };

  /// Between the data pages and a space of the card, in as many descriptors as faults make of it.
  void move(card::Space space, std::uint32_t offset, std::uint32_t bytes, bool to_host) {
    unsigned failures = 0;
    for (std::uint32_t done = 0; done < bytes;) {
      const Ending e = serve(kDataPage * kPageBytes + done, space,
                             space == card::kSpaceSram ? 0 : offset + done, bytes - done, to_host);
      if (e.code == pci::kCodeOk) return;
      failures = e.bytes != 0 ? 1 : failures + 1;
      done += e.bytes;
      const bool passing = e.code == pci::kCodeMasterAbort || e.code == pci::kCodeTargetAbort ||
                           e.code == pci::kCodeParity || e.code == pci::kCodeRetryLimit;
      // Records that had left the ring when the transfer failed are gone.
      const bool stream = space == card::kSpaceSram;
      start_ring();
      if (!passing || stream || failures > retries_) {
        fail(fmt::format("DMA of {} bytes {} space {} offset {:#x}: {} after {} bytes", bytes,
                         to_host ? "from" : "to", static_cast<int>(space), offset, text_of(e.code),
                         done),
             {.code = e.code,
              .pci_status = e.pci_status,
              .address = e.address,
              .repeatable = passing && stream});
      }
      ++counters_.transfer_retries;
    }
  }

  Ending serve(std::uint32_t mapped, card::Space space, std::uint32_t offset, std::uint32_t bytes,
               bool to_host) {
    alive();
    const std::uint64_t words[4] = {std::uint64_t{bytes} << 32 | mapped,
                                    std::uint64_t{offset} |
                                        std::uint64_t{space} << pci::kDescriptorSpace |
                                        std::uint64_t{to_host} << pci::kDescriptorToHost |
                                        std::uint64_t{1} << pci::kDescriptorIrq,
                                    0, 0};
    const unsigned number = next_;
    std::memcpy(page(kRingPage) + number * pci::kDescriptorBytes, words, sizeof words);
    next_ = (next_ + 1) % kDescriptors;
    set(pci::kRegIrqMask, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    set(pci::kRegRingTail, next_);
    const Ending e = wait(number, bytes);
    if (next_ == 0) lap_ = !lap_;
    set(pci::kRegIrqStatus, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    set(pci::kRegIrqMask, 1u << pci::kIrqCard);
    ++counters_.transfers;
    return e;
  }

  /// The completion record, or what the registers say if there can be none.
  Ending wait(unsigned number, std::uint32_t bytes) {
    // No host is slower than a burst of 8 bytes in 10 microseconds.
    const std::uint64_t deadline = time_ps() + 10'000'000'000 + std::uint64_t{bytes} * 1'250'000;
    for (std::uint64_t slice = kFirstAskClocks * period_ps_;; slice *= 2) {
      api_->run(host_, slice, 1);
      const bool interrupted = api_->interrupt(host_) != 0;
      std::uint64_t record[2];
      std::memcpy(record, page(kCompletionPage) + number * pci::kCompletionBytes, sizeof record);
      // Either word may have been lost to a parity error.
      const std::uint64_t lap = lap_ ? 1 : 0;
      if ((record[1] >> pci::kCompletionLap & 1) == lap &&
          (record[0] >> (32 + pci::kCompletionLapFirst) & 1) == lap) {
        counters_.lost_interrupts += interrupted ? 0 : 1;
        return {static_cast<std::uint32_t>(record[1] >> pci::kCompletionCode & 0xff),
                static_cast<std::uint32_t>(record[0] >> 32) & ~7u,
                static_cast<std::uint32_t>(record[0]),
                static_cast<std::uint16_t>(record[1] >> pci::kCompletionPci)};
      }
      const std::uint64_t status = load(pci::kRegStatus);
      if ((status >> pci::kStatusHalted & 1) != 0) {
        return {static_cast<std::uint32_t>(status >> pci::kStatusCode & 0xff), 0,
                static_cast<std::uint32_t>(load(pci::kRegFaultAddr)), 0};
      }
      if (time_ps() > deadline) {
        const DeviceFault fault{.address = number, .clock = clocks()};
        throw Error(
            ErrorCode::kTimeout,
            fmt::format("DMA descriptor {} of {} bytes did not end (status {:#x}, clock {})",
                        number, bytes, status, fault.clock),
            fault);
      }
    }
  }

  Bitstream bitstream_;
  const cde_pci_api* api_ = nullptr;
  void* host_ = nullptr;
  std::uint32_t period_ps_;
  unsigned retries_;
  std::uint32_t burst_;
  unsigned next_ = 0;  // descriptor
  bool lap_ = true, lost_ = false, pending_ = false;
  std::uint64_t lost_clock_ = 0;
  BusCounters counters_;
};

}  // namespace

std::unique_ptr<CardLink> pci_link(Bitstream bitstream, const OpenOptions& options) {
  return std::make_unique<PciLink>(std::move(bitstream), options);
}

}  // namespace cde
