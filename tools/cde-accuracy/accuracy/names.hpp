// SPDX-License-Identifier: Apache-2.0
#pragma once

/// This program speaks of the library cde::accuracy all the time: its names stand without a prefix.
namespace cde::accuracy {}
namespace cde::cli {
using namespace accuracy;
}  // namespace cde::cli
