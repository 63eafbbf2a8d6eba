// SPDX-License-Identifier: Apache-2.0
// Used in a command that is built without MPI.
#include <cstdlib>

#include "cde/jobs/work_ranks.hpp"
#include "cde/support/error.hpp"

namespace cde {

std::unique_ptr<WorkDistributor::Ranks> WorkDistributor::Ranks::if_started() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* size = std::getenv(name);
    if (size != nullptr && std::atoi(size) > 1)
      throw Error(ErrorCode::kConfiguration,
                  "this cde was built without MPI (CDE_MPI), so every rank would do all the work; "
                  "use --shard, or build cde with Open MPI");
  }
  return nullptr;
}

}  // namespace cde
