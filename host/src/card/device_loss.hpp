// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <optional>
#include <string>

#include "cde/support/error.hpp"

namespace cde {

/// An Error with a device fault. Its message also describes the fault.
[[nodiscard]] inline Error device_error(ErrorCode code, const std::string& what,
                                        const DeviceFault& fault) {
  return {code,
          fmt::format("{} (PCI status {:#06x}, address {:#x}, cycle {})", what, fault.pci_status,
                      fault.address, fault.cycle),
          fault};
}

/// Whether a device is lost. Every access then throws the first reason, until reset(). Private to
/// the driver.
class DeviceLoss {
 public:
  /// Throws if the device is lost.
  void alive() const {
    if (error_) throw Error(*error_);
  }
  [[nodiscard]] bool lost() const { return error_.has_value(); }
  void reset() { error_.reset(); }
  [[noreturn]] void lose(const Error& error) {
    if (!error_) error_ = error;
    throw Error(*error_);
  }
  [[noreturn]] void lose(ErrorCode code, const std::string& what, const DeviceFault& fault) {
    lose(device_error(code, what + "; the device is lost until reset()", fault));
  }

 private:
  std::optional<Error> error_;
};

}  // namespace cde
