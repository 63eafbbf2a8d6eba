// SPDX-License-Identifier: Apache-2.0
// Coverage of the RTL. A harness calls cde_write_coverage when it destroys its model. In a model
// built with CDE_RTL_COVERAGE=1 the call writes the model's counters; in any other it does nothing.
#ifndef CDE_COVERAGE_H
#define CDE_COVERAGE_H

#include <verilated.h>

#ifdef CDE_RTL_COVERAGE
#include <unistd.h>
#include <verilated_cov.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#endif

/// Writes $CDE_RTL_COVERAGE_DIR/KIND-CONFIG-PID-N.dat for verilator_coverage. Without the variable
/// it writes nothing.
inline void cde_write_coverage([[maybe_unused]] VerilatedContext* context,
                               [[maybe_unused]] const char* kind) {
#ifdef CDE_RTL_COVERAGE
  static std::atomic<unsigned> models{0};
  const char* dir = std::getenv("CDE_RTL_COVERAGE_DIR");
  if (dir == nullptr || *dir == '\0') return;
  char path[4096];
  const int length = std::snprintf(path, sizeof path, "%s/%s-%016llx-%d-%u.dat", dir, kind,
                                   static_cast<unsigned long long>(CDE_CONFIG_HASH),
                                   static_cast<int>(::getpid()), models.fetch_add(1));
  if (length > 0 && static_cast<unsigned>(length) < sizeof path) context->coveragep()->write(path);
#endif
}

#endif
