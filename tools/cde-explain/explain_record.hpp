// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::cli {

/// `cde explain --from-record`.
struct RecordRequest {
  std::string name;     ///< RUN:QUERY:FRAME:PRIMARY
  unsigned most = 100;  ///< most lines of a list, 0: all
  bool exact = false;   ///< only the planned card
  bool json = false;
};
/// Prints the explanation of the record. Sets exit_code to the status of a mismatch if card and
/// reference differ.
void explain_record(const RecordRequest& request);

}  // namespace cde::cli
