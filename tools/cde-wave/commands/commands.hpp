// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/wave/request.hpp"

/// The commands of `cde wave`. Each prints its answer and returns the exit status.
namespace cde::wave {

[[nodiscard]] int info(const Request& request);
[[nodiscard]] int list(const Request& request);
[[nodiscard]] int values_at(const Request& request);
[[nodiscard]] int show(const Request& request);
[[nodiscard]] int find(const Request& request);
[[nodiscard]] int diff(const Request& request);
[[nodiscard]] int statistics(const Request& request);
[[nodiscard]] int export_waves(const Request& request);
[[nodiscard]] int serve(const Request& request);
[[nodiscard]] int terminal_viewer(const Request& request);
[[nodiscard]] int transaction_table(const Request& request);
[[nodiscard]] int why(const Request& request);
}  // namespace cde::wave
