// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <stdexcept>
#include <string>

#include "cde/support/device_fault.hpp"

namespace cde {

/// What went wrong, for programs; the message of Error says it for people.
enum class ErrorCode {
  kUsage,          ///< an argument or option makes no sense
  kFile,           ///< a file is missing, unreadable, malformed, or cannot be written
  kBadInput,       ///< a primitive or mesh breaks its contract (NaN, infinity, zero direction, no
                   ///< triangles)
  kCapacity,       ///< more objects than the card's memory holds
  kConfiguration,  ///< the bitstream is not the configuration that was asked for
  kBuild,          ///< a bitstream could not be built
  kDevice,         ///< the card answered against its contract
  kMismatch,       ///< hardware and software reference differ
  kTimeout,        ///< the card did not finish within its deadline
  kInterrupted,    ///< a signal ended the building of a bitstream; signal() says which
};

/// The one exception type of the library. `what()` names the file, line, field or register
/// concerned.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message,
        const std::optional<DeviceFault>& fault = std::nullopt)
      : std::runtime_error(message), code_(code), fault_(fault) {}
  /// kInterrupted.
  Error(int signal, const std::string& message)
      : std::runtime_error(message), code_(ErrorCode::kInterrupted), signal_(signal) {}
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  /// Of kDevice and kTimeout, of an access, a transfer or a pass.
  [[nodiscard]] const std::optional<DeviceFault>& fault() const noexcept { return fault_; }
  /// Of kInterrupted, else 0.
  [[nodiscard]] int signal() const noexcept { return signal_; }

 private:
  ErrorCode code_;
  int signal_ = 0;
  std::optional<DeviceFault> fault_;
};

/// Throws Error kUsage.
[[noreturn]] void throw_usage(const std::string& message);

/// Process exit status for an error: 2 usage or file or input, 3 mismatch with the reference, 4 the
/// card failed (kTimeout, kDevice).
[[nodiscard]] int exit_status(ErrorCode code) noexcept;
/// The same, and 128 and the signal of kInterrupted.
[[nodiscard]] int exit_status(const Error& error) noexcept;

}  // namespace cde
