// SPDX-License-Identifier: Apache-2.0
#include "card/pci_port.hpp"

#include <fmt/format.h>

#include "card/abi_table.hpp"
#include "cde/contract/pci.hpp"

namespace cde {

PciPort::PciPort(SimulationModel model, const OpenOptions& options, std::uint64_t memory_bytes)
    : model_(std::move(model)),
      period_ps_(options.clock_period_ps),
      retries_(options.bus_retries),
      watchdog_(options.watchdog) {
  api_ = abi_table<cde_pci_entry_fn>(model_, "cde_pci_entry", CDE_PCI_ABI);
  const HostProfile& p = options.host;
  const cde_pci_options card_options = {
      .core_period_ps = period_ps_,
      .pci_period_ps = 15'000,
      .memory = static_cast<std::uint32_t>(options.memory),
      .ddr_latency = options.ddr_latency,
      .narrow = options.narrow_bus ? 1u : 0u,
      .memory_bytes = memory_bytes,
      .seed = 1,
      .profile = {p.arbitration, p.read_latency, p.write_latency, 0, 0}};
  host_ = api_->create(&card_options);
  if (host_ == nullptr) no_memory_for_models();
}

void PciPort::reset() {
  api_->reset(host_);
  loss_.reset();
  posted_ = false;
}

// ---- Accesses ----

void PciPort::store(std::uint32_t offset, const void* data, std::uint64_t bytes) {
  access([&] { return api_->mmio_write(host_, offset, data, static_cast<std::uint32_t>(bytes)); },
         offset, "register write");
  posted_ = true;
}

void PciPort::fetch(std::uint32_t offset, void* data, std::uint64_t bytes) {
  access([&] { return api_->mmio_read(host_, offset, data, static_cast<std::uint32_t>(bytes)); },
         offset, "register read");
  posted_ = false;
}

std::uint64_t PciPort::load(std::uint32_t offset) {
  std::uint64_t value = 0;
  fetch(offset, &value, 8);
  return value;
}

std::uint32_t PciPort::config_read(std::uint32_t offset) {
  std::uint32_t value = 0;
  access([&] { return api_->config_read(host_, offset, &value); }, offset,
         "read of configuration space");
  return value;
}

void PciPort::config_write(std::uint32_t offset, std::uint32_t value) {
  access([&] { return api_->config_write(host_, offset, value); }, offset,
         "write of configuration space");
}

/// Repeats failed accesses, which is always safe: reads have no side effects, the card drops writes
/// with bad parity, and unclaimed accesses have no effect.
void PciPort::access(const std::function<int()>& once, std::uint32_t offset, const char* what) {
  alive();
  const Watchdog dog = watchdog();
  ++accesses_;
  int status = once();
  for (unsigned i = 0; i < retries_ && !dog.barked(); ++i) {
    if (status != CDE_PCI_PARITY && status != CDE_PCI_MASTER_ABORT) break;
    ++retried_;
    status = once();
  }
  if (status != CDE_PCI_OK) failed(status, offset, what);
}

void PciPort::failed(int status, std::uint32_t offset, const char* what) {
  const auto fault = [&](std::uint32_t code) {
    return DeviceFault{.code = code, .address = offset};
  };
  const std::string at = fmt::format("{} at offset {:#x}", what, offset);
  switch (status) {
    case CDE_PCI_MASTER_ABORT:
      lose(ErrorCode::kDevice, at + ": the card does not answer", fault(pci::kCodeMasterAbort));
    case CDE_PCI_STUCK:
      lose(ErrorCode::kDevice, at + ": the bus hangs", fault(pci::kCodeRetryLimit));
    case CDE_PCI_TARGET_ABORT:
      fail(at + ": target abort", fault(pci::kCodeTargetAbort));
    case CDE_PCI_PARITY:
      fail(at + ": parity error", fault(pci::kCodeParity));
    default:
      fail(at + ": the card only answers with retry", fault(pci::kCodeRetryLimit));
  }
}

// ---- Errors ----

std::uint16_t PciPort::pci_status() {
  std::uint32_t status = 0;
  const bool ok = api_->config_read(host_, 0x04, &status) == CDE_PCI_OK;
  return ok ? static_cast<std::uint16_t>(status >> 16) : std::uint16_t{0xffff};
}

DeviceFault PciPort::complete(DeviceFault fault) {
  if (fault.pci_status == 0) fault.pci_status = pci_status();
  fault.cycle = cycles();
  return fault;
}

void PciPort::fail(const std::string& what, const DeviceFault& fault) {
  throw device_error(ErrorCode::kDevice, what, complete(fault));
}

void PciPort::lose(ErrorCode code, const std::string& what, const DeviceFault& fault) {
  loss_.lose(code, what, complete(fault));
}

}  // namespace cde
