// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::cli {

/// `cde explain --from-record`.
struct RecordRequest {
  std::string name;     ///< RUN:QUERY:FRAME:PRIMARY
  unsigned most = 100;  ///< lines of a list, 0 for all
  bool exact = false;   ///< the planned card and no other
  bool json = false;
};
/// Prints how the record came about; exit_code is that of a mismatch if the sides differ.
void explain_record(const RecordRequest& request);

}  // namespace cde::cli
