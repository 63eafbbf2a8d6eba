// SPDX-License-Identifier: Apache-2.0
#include "bus_card.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <ostream>
#include <stdexcept>

#include "cde/card/host_profile.hpp"

namespace cde::pci {

void PrintTo(Code code, std::ostream* out) {
  static constexpr const char* kNames[] = {
      "ok",           "length", "alignment",   "unmapped", "read only", "master abort",
      "target abort", "parity", "retry limit", "settings", "stopped",   "disabled"};
  if (code < std::size(kNames))
    *out << kNames[code];
  else if (code == testing::kNoRecord)
    *out << "no record";
  else
    *out << "unknown code " << +code;
}

void PrintTo(Where where, std::ostream* out) {
  static constexpr const char* kNames[] = {"data", "descriptor", "completion", "settings"};
  if (where < std::size(kNames))
    *out << kNames[where];
  else
    *out << "unknown place " << +where;
}

}  // namespace cde::pci

namespace cde::testing {

void PrintTo(Ending a, std::ostream* out) {
  static constexpr const char* kNames[] = {"ok",     "master abort", "target abort",
                                           "parity", "retried",      "stuck"};
  if (a.code >= 0 && a.code < static_cast<int>(std::size(kNames)))
    *out << kNames[a.code];
  else
    *out << "unknown ending " << a.code;
}

::testing::AssertionResult same_bytes(std::span<const std::uint8_t> got,
                                      std::span<const std::uint8_t> wanted) {
  constexpr std::size_t kShown = 16;
  const auto [g, w] = std::ranges::mismatch(got, wanted);
  if (g == got.end() && w == wanted.end()) return ::testing::AssertionSuccess();
  const auto at = static_cast<std::size_t>(g - got.begin());
  ::testing::AssertionResult result = ::testing::AssertionFailure();
  const auto show = [&](const char* what, std::span<const std::uint8_t> bytes) {
    result << what << " (" << bytes.size() << " bytes):";
    for (const std::uint8_t byte : bytes.subspan(at, std::min(kShown, bytes.size() - at))) {
      char text[4];
      std::snprintf(text, sizeof text, " %02x", byte);
      result << text;
    }
  };
  result << "first difference at offset " << at << " on, ";
  show("got", got);
  result << ", ";
  show("expected", wanted);
  return result;
}

cde_pci_profile profile(const std::string& name) {
  const HostProfile p = host_profile(name).value();
  return {.arbitration = p.arbitration,
          .read_latency = p.read_latency,
          .write_latency = p.write_latency,
          .wait_every = 0,
          .waits = 0};
}

namespace {

/// Looking up a model takes a third of a second, and each test opens a card.
SimulationModel model(const BusOptions& options) {
  static std::map<std::pair<std::string, std::vector<std::string>>, SimulationModel> known;
  const auto key = std::pair(options.kind, options.parameters);
  const auto found = known.find(key);
  return found != known.end()
             ? found->second
             : known.emplace(key, SimulationModel::open(options.kind, options.parameters))
                   .first->second;
}

}  // namespace

BusCard::BusCard(const BusOptions& options)
    : model_(model(options)),
      api_(reinterpret_cast<cde_pci_entry_fn>(model_.symbol("cde_pci_entry"))()) {
  if (api_->head.version != CDE_PCI_ABI || api_->head.size != sizeof *api_)
    throw std::runtime_error("another version of abi_pci.h");
  const cde_pci_options o = {.core_period_ps = options.core_period_ps,
                             .pci_period_ps = 15'000,
                             .memory = CDE_MEMORY_IDEAL,
                             .ddr_latency = 20,
                             .narrow = options.narrow,
                             .memory_bytes = options.memory_bytes,
                             .seed = options.seed,
                             .profile = profile(options.profile)};
  handle_ = api_->create(&o);
  if (handle_ == nullptr) throw std::runtime_error("no card");
}

BusCard::~BusCard() {
  const char* const violation = api_->violation(handle_);
  EXPECT_EQ(violation, nullptr) << violation;
  api_->destroy(handle_);
}

void BusCard::enumerate(std::uint32_t command, std::uint8_t latency_timer) {
  set_config(0x10, kBar);
  set_config(0x0C, std::uint32_t{latency_timer} << 8 | 8);
  set_config(0x04, command);
}

std::uint32_t BusCard::config(std::uint32_t offset) const {
  std::uint32_t value = 0;
  EXPECT_EQ(Ending{api_->config_read(handle_, offset, &value)}, CDE_PCI_OK) << offset;
  return value;
}
void BusCard::set_config(std::uint32_t offset, std::uint32_t value) const {
  EXPECT_EQ(Ending{api_->config_write(handle_, offset, value)}, CDE_PCI_OK) << offset;
}

std::uint64_t BusCard::read(std::uint32_t offset) const {
  std::uint64_t value = 0;
  EXPECT_EQ(Ending{api_->mmio_read(handle_, offset, &value, 8)}, CDE_PCI_OK) << offset;
  return value;
}
void BusCard::write(std::uint32_t offset, std::uint64_t value) const {
  EXPECT_EQ(Ending{api_->mmio_write(handle_, offset, &value, 8)}, CDE_PCI_OK) << offset;
}
std::uint32_t BusCard::read32(std::uint32_t offset) const {
  std::uint32_t value = 0;
  EXPECT_EQ(Ending{api_->mmio_read(handle_, offset, &value, 4)}, CDE_PCI_OK) << offset;
  return value;
}
void BusCard::write32(std::uint32_t offset, std::uint32_t value) const {
  EXPECT_EQ(Ending{api_->mmio_write(handle_, offset, &value, 4)}, CDE_PCI_OK) << offset;
}
cde_pci_counters BusCard::counters() const {
  cde_pci_counters c{};
  api_->counters(handle_, &c);
  return c;
}
void BusCard::fault(std::uint32_t kind, std::uint32_t count, std::uint32_t value) const {
  ASSERT_EQ(api_->fault(handle_, kind, count, value), 0);
}

void BusCard::map(std::uint32_t entry, std::uint32_t page, bool writable, bool valid) const {
  const std::uint64_t frame = api_->frame(handle_, page);
  ASSERT_NE(static_cast<std::uint32_t>(frame), ~0u) << "no page of host memory at this address";
  write(pci::kPageTable + 8 * entry, frame << pci::kPageFrame |
                                         std::uint64_t{valid} << pci::kPageValid |
                                         std::uint64_t{writable} << pci::kPageWritable);
}

void BusCard::map_range(std::uint32_t first, std::uint32_t last) const {
  std::vector<std::uint64_t> entries;
  for (std::uint32_t page = first; page <= last; ++page)
    entries.push_back(std::uint64_t{api_->frame(handle_, page)} << pci::kPageFrame |
                      1u << pci::kPageValid | 1u << pci::kPageWritable);
  EXPECT_EQ(api_->mmio_write(handle_, pci::kPageTable + 8 * first, entries.data(),
                             static_cast<std::uint32_t>(8 * entries.size())),
            CDE_PCI_OK);
}

void BusCard::put(std::uint32_t mapped, std::span<const std::uint8_t> bytes) const {
  for (std::size_t i = 0; i < bytes.size();) {
    const std::uint32_t at = mapped + static_cast<std::uint32_t>(i);
    const std::size_t n = std::min<std::size_t>(bytes.size() - i, 4096 - at % 4096);
    auto* const page =
        static_cast<std::uint8_t*>(api_->memory(handle_, api_->frame(handle_, at / 4096)));
    ASSERT_NE(page, nullptr);
    std::memcpy(page + at % 4096, bytes.data() + i, n);
    i += n;
  }
}

std::vector<std::uint8_t> BusCard::get(std::uint32_t mapped, std::uint32_t bytes) const {
  std::vector<std::uint8_t> out(bytes);
  for (std::uint32_t i = 0; i < bytes;) {
    const std::uint32_t at = mapped + i, n = std::min(bytes - i, 4096 - at % 4096);
    const auto* const page =
        static_cast<const std::uint8_t*>(api_->memory(handle_, api_->frame(handle_, at / 4096)));
    std::memcpy(out.data() + i, page + at % 4096, n);
    i += n;
  }
  return out;
}

std::span<std::uint8_t> BusCard::local(card::Space space) const {
  std::uint64_t bytes = 0;
  auto* const p = static_cast<std::uint8_t*>(api_->local_memory(handle_, space, &bytes));
  return {p, bytes};
}

void BusCard::start_ring(unsigned size, std::uint32_t burst) {
  map_range(kRingPage, kCompletionPage);
  put(kCompletionPage * 4096, std::vector<std::uint8_t>(4096));
  size_ = size;
  tail_ = next_ = 0;
  lap_ = true;
  write(pci::kRegControl, 1u << pci::kControlClear);
  write(pci::kRegIrqStatus, ~0ull);
  write(pci::kRegRingBase, kRingPage * 4096);
  write(pci::kRegCompletionBase, kCompletionPage * 4096);
  write(pci::kRegRingSize, size);
  write(pci::kRegBurst, burst);
  write(pci::kRegIrqMask, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
  write(pci::kRegControl, 1u << pci::kControlRun);
}

void BusCard::clear() {
  write(pci::kRegControl, 1u << pci::kControlClear);
  write(pci::kRegIrqStatus, ~0ull);
  put(kCompletionPage * 4096, std::vector<std::uint8_t>(4096));
  tail_ = next_ = 0;
  lap_ = true;
}

void BusCard::stage(const pci::Descriptor& d) {
  static_assert(sizeof d == pci::kDescriptorBytes);
  std::uint8_t raw[sizeof d];
  std::memcpy(raw, &d, sizeof d);
  put(kRingPage * 4096 + tail_ * pci::kDescriptorBytes, raw);
  tail_ = (tail_ + 1) % size_;
}
void BusCard::publish() const {
  write(pci::kRegRingTail, tail_);
}
void BusCard::submit(const pci::Descriptor& d) {
  stage(d);
  publish();
}

Result BusCard::wait(double microseconds) {
  const std::uint64_t end = api_->time_ps(handle_) + static_cast<std::uint64_t>(microseconds * 1e6);
  for (bool over = false;;) {
    pci::Completion c;
    const auto raw = get(kCompletionPage * 4096 + next_ * pci::kCompletionBytes, sizeof c);
    std::memcpy(&c, raw.data(), sizeof c);
    const std::uint64_t lap = lap_ ? 1 : 0;
    if ((c.state >> pci::kCompletionLap & 1) == lap &&
        (c.bytes >> pci::kCompletionLapFirst & 1) == lap) {
      next_ = (next_ + 1) % size_;
      if (next_ == 0) lap_ = !lap_;
      return {.number = static_cast<unsigned>(c.state >> pci::kCompletionNumber & 0xFFFF),
              .code = static_cast<pci::Code>(c.state >> pci::kCompletionCode & 0xFF),
              .bytes = c.bytes & ~7u,
              .fault = c.fault,
              .pci_status = static_cast<std::uint16_t>(c.state >> pci::kCompletionPci)};
    }
    const std::uint64_t now = api_->time_ps(handle_);
    if (now >= end || over) return {.code = kNoRecord};
    api_->run(handle_, std::min<std::uint64_t>(end - now, 2'000'000), 1);
    if (api_->interrupt(handle_) != 0) {
      write(pci::kRegIrqStatus, 1u << pci::kIrqCompletion);
      over = halted() && status_where() != pci::kWhereData;  // a pending record is still written
      if (halted()) write(pci::kRegIrqStatus, 1u << pci::kIrqHalted);
    }
  }
}

pci::Descriptor BusCard::descriptor(std::uint32_t mapped, std::uint32_t bytes, card::Space space,
                                    std::uint32_t offset, bool to_host, bool irq) {
  return {.address = mapped,
          .bytes = bytes,
          .local = offset | std::uint64_t{space} << pci::kDescriptorSpace |
                   std::uint64_t{to_host} << pci::kDescriptorToHost |
                   std::uint64_t{irq} << pci::kDescriptorIrq};
}

pci::Code BusCard::status_code() const {
  return static_cast<pci::Code>(read(pci::kRegStatus) >> pci::kStatusCode & 0xFF);
}
pci::Where BusCard::status_where() const {
  return static_cast<pci::Where>(read(pci::kRegStatus) >> pci::kStatusWhere & 0xFF);
}

}  // namespace cde::testing
