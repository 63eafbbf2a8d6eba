// SPDX-License-Identifier: Apache-2.0
#include "cde/card/machine.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "cde/card/memory.hpp"

namespace cde {

nlohmann::ordered_json machine_json() {
  std::string model = "unknown";
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) model = line.substr(line.find(':') + 2);
  }
  utsname system{};
  ::uname(&system);
  return {{"processor", model},
          {"processors", std::thread::hardware_concurrency()},
          {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)}};
}

std::uint64_t memory_limit() {
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  std::uint64_t most = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * page;
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const std::uint64_t used = pages * page + kModelBytes;
    most = std::min<std::uint64_t>(most, limit.rlim_cur > used ? limit.rlim_cur - used : 0);
  }
  return most / 4 * 3;
}

}  // namespace cde
