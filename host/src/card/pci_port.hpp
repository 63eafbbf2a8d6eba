// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "card/device_loss.hpp"
#include "cde/abi/abi_pci.h"
#include "cde/card/board.hpp"
#include "cde/support/error.hpp"

namespace cde {

/// A wall-time limit from construction on. It ends a simulation that makes no progress.
class Watchdog {
 public:
  explicit Watchdog(std::chrono::duration<double> limit)
      : end_(std::chrono::steady_clock::now() + limit) {}
  [[nodiscard]] bool barked() const { return std::chrono::steady_clock::now() > end_; }

 private:
  std::chrono::time_point<std::chrono::steady_clock, std::chrono::duration<double>> end_;
};

/// The simulated host with its card, and the CPU's accesses to the card. Accesses that fail for a
/// transient reason are repeated up to OpenOptions::bus_retries times. If the card answers none of
/// them, or the bus or DMA engine hangs, the device is lost. The error is thrown then and by every
/// later access, until reset(). Private to the driver.
class PciPort {
 public:
  /// Error kConfiguration if the simulation model has another interface, kDevice if there is no
  /// memory for the card. The host gets `memory_bytes` of memory.
  PciPort(SimulationModel model, const OpenOptions& options, std::uint64_t memory_bytes);
  PciPort(const PciPort&) = delete;
  PciPort& operator=(const PciPort&) = delete;
  ~PciPort() { api_->destroy(host_); }

  [[nodiscard]] const cde_pci_api& api() const { return *api_; }
  [[nodiscard]] void* host() const { return host_; }

  /// Asserts RST#. The card answers again, but is not set up.
  void reset();

  /// Accesses registers. Offsets are in BAR0; sizes are multiples of 8 bytes.
  void store(std::uint32_t offset, const void* data, std::uint64_t bytes);
  void fetch(std::uint32_t offset, void* data, std::uint64_t bytes);
  void set(std::uint32_t offset, std::uint64_t value) { store(offset, &value, 8); }
  [[nodiscard]] std::uint64_t load(std::uint32_t offset);
  [[nodiscard]] std::uint32_t config_read(std::uint32_t offset);
  void config_write(std::uint32_t offset, std::uint32_t value);

  /// Throws if the device is lost.
  void alive() const { loss_.alive(); }
  [[nodiscard]] bool lost() const { return loss_.lost(); }
  /// Throws kDevice with the fault, and adds PCI status and clock. The message also describes them.
  [[noreturn]] void fail(const std::string& what, const DeviceFault& fault);
  /// Also marks the device as lost.
  [[noreturn]] void lose(ErrorCode code, const std::string& what, const DeviceFault& fault);
  /// Marks the device as lost after an error that leaves the card in an unknown state.
  [[noreturn]] void lose(const Error& error) { loss_.lose(error); }

  /// Whether a write may not have reached the card yet. Writes are posted, and a read pushes them
  /// through.
  [[nodiscard]] bool posted() const { return posted_; }

  [[nodiscard]] std::uint64_t time_ps() const { return api_->time_ps(host_); }
  [[nodiscard]] std::uint64_t cycles() const { return time_ps() / period_ps_; }
  /// Status register of configuration space; all ones if the card does not answer.
  [[nodiscard]] std::uint16_t pci_status();
  [[nodiscard]] Watchdog watchdog() const { return Watchdog(watchdog_); }
  [[nodiscard]] std::uint64_t accesses() const { return accesses_; }
  [[nodiscard]] std::uint64_t access_retries() const { return retried_; }

 private:
  void access(const std::function<int()>& once, std::uint32_t offset, const char* what);
  [[noreturn]] void failed(int status, std::uint32_t offset, const char* what);
  [[nodiscard]] DeviceFault complete(DeviceFault fault);

  SimulationModel model_;
  const cde_pci_api* api_ = nullptr;
  void* host_ = nullptr;
  std::uint32_t period_ps_;
  unsigned retries_;
  std::chrono::duration<double> watchdog_;
  DeviceLoss loss_;
  bool posted_ = false;
  std::uint64_t accesses_ = 0, retried_ = 0;
};

}  // namespace cde
