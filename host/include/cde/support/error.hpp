// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <stdexcept>
#include <string>

#include "cde/support/device_fault.hpp"

namespace cde {

/// What went wrong, for programs. The message of Error says it to people.
enum class ErrorCode {
  kUsage,          ///< an argument or option is invalid
  kFile,           ///< a file is missing, unreadable, malformed, or cannot be written
  kBadInput,       ///< a primitive or mesh breaks its contract (NaN, infinity, zero direction, no
                   ///< triangles)
  kCapacity,       ///< more objects than the card's memory holds
  kConfiguration,  ///< the simulation model does not have the requested configuration
  kBuild,          ///< a simulation model could not be built
  kDevice,         ///< the card answered against its contract
  kMismatch,       ///< hardware and software reference differ
  kTimeout,        ///< the card did not finish within its deadline
  kInterrupted,    ///< a signal ended the build of a simulation model; see signal()
};

/// The only exception type of the library. `what()` names the file, line, field or register
/// concerned.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message,
        const std::optional<DeviceFault>& fault = std::nullopt)
      : std::runtime_error(message), code_(code), fault_(fault) {}
  /// Error kInterrupted.
  Error(int signal, const std::string& message)
      : std::runtime_error(message), code_(ErrorCode::kInterrupted), signal_(signal) {}
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  /// Set for kDevice and kTimeout if an access, a transfer or a pass failed.
  [[nodiscard]] const std::optional<DeviceFault>& fault() const noexcept { return fault_; }
  /// The signal of kInterrupted, else 0.
  [[nodiscard]] int signal() const noexcept { return signal_; }

 private:
  ErrorCode code_;
  int signal_ = 0;
  std::optional<DeviceFault> fault_;
};

/// Throws Error kUsage.
[[noreturn]] void throw_usage(const std::string& message);

/// Exit status of a process for an error. 2: usage, file or input; 3: mismatch with the reference;
/// 4: the card failed (kTimeout, kDevice).
[[nodiscard]] int exit_status(ErrorCode code) noexcept;
/// The same; kInterrupted gives 128 + signal.
[[nodiscard]] int exit_status(const Error& error) noexcept;

}  // namespace cde
