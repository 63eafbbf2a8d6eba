// Coverage of the RTL. A harness calls write_rtl_coverage when its model is destroyed; in a
// bitstream built with CDE_RTL_COVERAGE=1 that writes the model's counters, in any other it is
// nothing.
#pragma once

#ifdef CDE_RTL_COVERAGE
#include <unistd.h>
#include <verilated.h>
#include <verilated_cov.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace cde {

/// Writes $CDE_RTL_COVERAGE_DIR/KIND-CONFIG-PID-N.dat for verilator_coverage; without the variable,
/// nothing.
inline void write_rtl_coverage(VerilatedContext& context, const char* kind) {
  static std::atomic<unsigned> models{0};
  const char* dir = std::getenv("CDE_RTL_COVERAGE_DIR");
  if (dir == nullptr || *dir == '\0') return;
  char path[4096];
  const int length = std::snprintf(path, sizeof path, "%s/%s-%016llx-%d-%u.dat", dir, kind,
                                   static_cast<unsigned long long>(CDE_CONFIG_HASH),
                                   static_cast<int>(::getpid()), models.fetch_add(1));
  if (length > 0 && static_cast<unsigned>(length) < sizeof path) context.coveragep()->write(path);
}

}  // namespace cde

#else

class VerilatedContext;
namespace cde {
inline void write_rtl_coverage(VerilatedContext&, const char*) {}
}  // namespace cde

#endif
