// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"

namespace cde::reference {
namespace {

constexpr std::size_t kChunk = 1024;  ///< rays that a thread takes at a time
constexpr std::chrono::milliseconds kBetweenStops(100);

/// Threads that take chunks of rays until none are left.
class Tracing {
 public:
  Tracing(const TriangleView& triangles, const Bvh& bvh, const RayView& rays,
          std::span<Record> records, const TraceRaysOptions& options)
      : triangles_(triangles), bvh_(bvh), rays_(rays), records_(records), options_(options) {}

  bool run(unsigned threads) {
    std::vector<std::thread> others;
    const auto join = [&] {
      for (std::thread& other : others) other.join();
    };
    try {
      for (unsigned k = 0; k < threads; ++k) others.emplace_back([this] { work(); });
      wait(threads);
    } catch (...) {
      ended_ = true;
      join();
      throw;
    }
    join();
    if (failed_) std::rethrow_exception(failed_);
    return !ended_;
  }

 private:
  void work() {
    try {
      Traversal traversal(triangles_, bvh_, options_.algorithm);
      while (!ended_) {
        const std::size_t first = next_.fetch_add(kChunk);
        if (first >= rays_.size()) break;
        for (std::size_t i = first; i < std::min(rays_.size(), first + kChunk); ++i)
          records_[i] = record(traversal, i);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failed_) failed_ = std::current_exception();
      ended_ = true;
    }
    const std::lock_guard lock(mutex_);
    ++done_;
    changed_.notify_one();
  }

  Record record(Traversal& traversal, std::size_t i) const {
    const auto number = static_cast<std::uint32_t>(i);
    const Ray ray = rays_[i];
    if (options_.mode != Mode::kOccluded)
      return traversal.trace(ray, number, options_.mode).front();
    // As the card: F alone, and bad rays as in the other modes.
    Record hit;
    hit.primary = number;
    hit.f = traversal.occluded(ray);
    return !hit.f && defect(ray) ? traversal.trace(ray, number, Mode::kAny).front() : hit;
  }

  void wait(unsigned threads) {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kBetweenStops, [&] { return done_ == threads; })) {
      if (!options_.stop) continue;
      lock.unlock();
      if (options_.stop()) ended_ = true;
      lock.lock();
    }
  }

  const TriangleView& triangles_;
  const Bvh& bvh_;
  const RayView& rays_;
  std::span<Record> records_;
  const TraceRaysOptions& options_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> ended_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  unsigned done_ = 0;
  std::exception_ptr failed_;
};

}  // namespace

bool trace_rays(const TriangleView& triangles, const Bvh& bvh, const RayView& rays,
                std::span<Record> records, const TraceRaysOptions& options) {
  if (options.mode == Mode::kAll || options.mode == Mode::kHits)
    throw Error(ErrorCode::kUsage,
                fmt::format("mode {} has any number of records per ray", name_of(options.mode)));
  if (records.size() != rays.size())
    throw Error(ErrorCode::kUsage,
                fmt::format("{} rays need as many records, not {}", rays.size(), records.size()));
  const unsigned most =
      options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const std::size_t chunks = std::max<std::size_t>(1, (rays.size() + kChunk - 1) / kChunk);
  return Tracing(triangles, bvh, rays, records, options)
      .run(static_cast<unsigned>(std::min<std::size_t>(most, chunks)));
}

}  // namespace cde::reference
