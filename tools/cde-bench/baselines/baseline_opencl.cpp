// SPDX-License-Identifier: Apache-2.0
#include "baselines/baseline_opencl.hpp"

#include "cde/support/error.hpp"

#ifdef CDE_OPENCL
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <fmt/format.h>
#include <time.h>
#include <CL/opencl.hpp>

#include <algorithm>
#include <bit>
#include <chrono>
#include <functional>
#include <numeric>
#include <utility>

#include "baselines/binary_bvh.hpp"
#include "cde/geometry/check.hpp"
#include "page/page.hpp"

namespace cde::cli {
extern const PageAsset kOpenClQueries;  // opencl_queries.cl
}

namespace cde::baseline {
namespace {

constexpr std::size_t kGroup = 64;  ///< work items per group
/// Most pairs per launch. Longer kernels may be ended by the watchdog of a GPU with a display.
constexpr std::uint64_t kMostPairs = std::uint64_t{1} << 34;
constexpr std::uint32_t kLeastChunk = 64;  ///< fewest triangles per work item of brute force

/// Runs `work`. An error of OpenCL becomes Error, which names `what`.
template <class Work>
auto guarded(const std::string& what, Work work) {
  try {
    return work();
  } catch (const cl::Error& e) {
    const bool memory = e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE ||
                        e.err() == CL_OUT_OF_RESOURCES || e.err() == CL_OUT_OF_HOST_MEMORY ||
                        e.err() == CL_INVALID_BUFFER_SIZE;
    throw Error(memory ? ErrorCode::kCapacity : ErrorCode::kDevice,
                fmt::format("{}: {} failed with OpenCL error {}{}", what, e.what(), e.err(),
                            memory ? ", out of memory" : ""));
  }
}

std::string kind_of(cl_device_type type) {
  if ((type & CL_DEVICE_TYPE_GPU) != 0) return "GPU";
  if ((type & CL_DEVICE_TYPE_CPU) != 0) return "CPU";
  return (type & CL_DEVICE_TYPE_ACCELERATOR) != 0 ? "accelerator" : "other";
}

/// Devices of all platforms, in the order of the loader.
std::vector<cl::Device> all_devices() {
  std::vector<cl::Device> all;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& e) {
    constexpr int kNoPlatform = -1001;  // CL_PLATFORM_NOT_FOUND_KHR
    if (e.err() != kNoPlatform)
      throw_usage(fmt::format("OpenCL: {} failed with error {}", e.what(), e.err()));
  }
  if (platforms.empty())
    throw_usage(
        "no OpenCL platform is installed; expected a driver in /etc/OpenCL/vendors (for a CPU, "
        "Debian: pocl-opencl-icd)");
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> some;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &some);
    } catch (const cl::Error& e) {
      if (e.err() != CL_DEVICE_NOT_FOUND)
        throw_usage(fmt::format("OpenCL: {} failed with error {}", e.what(), e.err()));
    }
    all.insert(all.end(), some.begin(), some.end());
  }
  if (all.empty()) throw_usage("the installed OpenCL platforms have no device");
  return all;
}

/// Text of the driver without the ends that some drivers add.
std::string trimmed(std::string text) {
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  const auto last = text.find_last_not_of(' ');
  text.erase(last == std::string::npos ? 0 : last + 1);
  return text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
}

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double thread_time() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A context, a queue that measures, and the compiled kernels.
struct OpenClProgram {
  OpenClDevice facts;
  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;
  cl::Program program;

  explicit OpenClProgram(const OpenClDevice& chosen) : facts(chosen) {
    const std::vector<cl::Device> all = all_devices();
    if (chosen.number >= all.size()) throw_usage("the OpenCL device has gone");
    device = all[chosen.number];
    guarded(facts.name, [&] {
      context = cl::Context(device);
      queue = cl::CommandQueue(context, device, CL_QUEUE_PROFILING_ENABLE);
      program = cl::Program(context, std::string(cli::kOpenClQueries.text));
    });
    const std::string options = facts.exact_division
                                    ? "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt"
                                    : "-cl-std=CL1.2";
    try {
      program.build({device}, options.c_str());
    } catch (const cl::Error& e) {
      throw Error(
          ErrorCode::kBuild,
          fmt::format("{}: the kernels cannot be compiled (OpenCL error {}): {}", facts.name,
                      e.err(), program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device)));
    }
  }

  /// Starts a kernel with at least `items` work items.
  cl::Event start(cl::Kernel& kernel, std::size_t items) {
    const std::size_t group =
        std::min(kGroup, kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device));
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                               cl::NDRange((items + group - 1) / group * group), cl::NDRange(group),
                               nullptr, &event);
    return event;
  }

  static double seconds(const cl::Event& event) {
    return 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                      event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
  }
};

/// A buffer that grows.
struct OpenClBuffer {
  cl::Buffer buffer;
  std::size_t bytes = 0;

  cl::Buffer& of(const cl::Context& context, std::size_t wanted) {
    if (bytes < wanted) {
      buffer = cl::Buffer(context, CL_MEM_READ_WRITE, wanted);
      bytes = wanted;
    }
    return buffer;
  }
};

/// A triangle as the kernels read it: three corners, the index behind the first.
struct PackedTriangle {
  float words[12];
};

PackedTriangle packed(const Triangle& t, std::uint32_t index) {
  return {{t.v0.x(), t.v0.y(), t.v0.z(), std::bit_cast<float>(index), t.v1.x(), t.v1.y(), t.v1.z(),
           0, t.v2.x(), t.v2.y(), t.v2.z(), 0}};
}

cl_float4 vector_of(const Eigen::Vector3f& v) {
  return {{v.x(), v.y(), v.z(), 0}};
}

template <class T>
void write(cl::CommandQueue& queue, const cl::Buffer& buffer, std::size_t first,
           std::span<const T> values) {
  queue.enqueueWriteBuffer(buffer, CL_FALSE, first * sizeof(T), values.size_bytes(), values.data());
}

}  // namespace

bool has_opencl() {
  return true;
}

std::vector<OpenClDevice> opencl_devices() {
  std::vector<OpenClDevice> devices;
  for (const cl::Device& d : all_devices()) {
    const auto config = d.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>();
    const cl::Platform platform(d.getInfo<CL_DEVICE_PLATFORM>());
    devices.push_back({.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>()),
                       .name = trimmed(d.getInfo<CL_DEVICE_NAME>()),
                       .driver = trimmed(d.getInfo<CL_DRIVER_VERSION>()),
                       .version = trimmed(d.getInfo<CL_DEVICE_VERSION>()),
                       .kind = kind_of(d.getInfo<CL_DEVICE_TYPE>()),
                       .compute_units = d.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>(),
                       .exact_division = (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0,
                       .subnormals = (config & CL_FP_DENORM) != 0,
                       .number = devices.size()});
  }
  return devices;
}

struct OpenClRays::Impl {
  OpenClProgram p;
  std::vector<PackedTriangle> in_order, in_leaves;
  BinaryBvh tree;
  BvhFacts facts;
  cl::Kernel brute_force, nearest_chunk, traverse;
  OpenClBuffer triangles, leaves, nodes, rays, partial, hits;

  Impl(const OpenClDevice& device, std::span<const Triangle> all) : p(device) {
    for (std::size_t i = 0; i < all.size(); ++i) check(all[i], fmt::format("triangle {}", i));
    const double start = thread_time();
    tree = BinaryBvh::build(all);
    for (const std::uint32_t i : tree.order) in_leaves.push_back(packed(all[i], i));
    facts = {.nodes = tree.nodes.size(),
             .bytes = tree.nodes.size() * sizeof(BinaryNode),
             .levels = tree.levels,
             .build_seconds = thread_time() - start};
    for (std::size_t i = 0; i < all.size(); ++i)
      in_order.push_back(packed(all[i], static_cast<std::uint32_t>(i)));
    guarded(p.facts.name, [&] {
      brute_force = cl::Kernel(p.program, "brute_force");
      nearest_chunk = cl::Kernel(p.program, "nearest_chunk");
      traverse = cl::Kernel(p.program, "traverse");
    });
  }

  /// Parts into which brute force divides the triangles, so that few rays also fill the device.
  [[nodiscard]] std::uint32_t chunks(std::size_t rays) const {
    const std::uint64_t items = std::uint64_t{2048} * p.facts.compute_units;
    const std::uint64_t most = (in_order.size() + kLeastChunk - 1) / kLeastChunk;
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(items / rays, 1, std::max<std::uint64_t>(most, 1)));
  }

  /// Starts the kernels for all rays.
  std::vector<cl::Event> start(std::size_t count, Through through) {
    std::vector<cl::Event> events;
    const auto rays_32 = static_cast<cl_uint>(count);
    if (through == Through::kBvh) {
      traverse.setArg(0, rays.buffer), traverse.setArg(1, rays_32);
      traverse.setArg(2, nodes.buffer), traverse.setArg(3, leaves.buffer);
      traverse.setArg(4, vector_of(tree.box.min())), traverse.setArg(5, vector_of(tree.box.max()));
      traverse.setArg(6, hits.buffer);
      return {p.start(traverse, count)};
    }
    const std::size_t most =
        std::clamp<std::size_t>(kMostPairs / in_order.size(), 1, std::size_t{1} << 20);
    for (std::size_t first = 0; first < count; first += most) {
      const auto some = static_cast<cl_uint>(std::min(most, count - first)),
                 from = static_cast<cl_uint>(first);
      const cl_uint parts = chunks(some);
      partial.of(p.context, std::size_t{some} * parts * sizeof(ClosestHit));
      brute_force.setArg(0, rays.buffer), brute_force.setArg(1, from);
      brute_force.setArg(2, some), brute_force.setArg(3, parts);
      brute_force.setArg(4, triangles.buffer);
      brute_force.setArg(5, static_cast<cl_uint>(in_order.size()));
      brute_force.setArg(6, partial.buffer);
      events.push_back(p.start(brute_force, std::size_t{some} * parts));
      nearest_chunk.setArg(0, partial.buffer), nearest_chunk.setArg(1, from);
      nearest_chunk.setArg(2, some), nearest_chunk.setArg(3, parts);
      nearest_chunk.setArg(4, hits.buffer);
      events.push_back(p.start(nearest_chunk, some));
    }
    return events;
  }
};

OpenClRays::OpenClRays(const OpenClDevice& device, std::span<const Triangle> triangles)
    : impl_(std::make_unique<Impl>(device, triangles)) {}
OpenClRays::~OpenClRays() = default;

const OpenClRays::BvhFacts& OpenClRays::bvh() const {
  return impl_->facts;
}

double OpenClRays::upload(Through through) {
  Impl& i = *impl_;
  const std::size_t bytes = i.in_order.size() * sizeof(PackedTriangle);
  return guarded(i.p.facts.name, [&] {
    if (through == Through::kBvh) {
      i.leaves.of(i.p.context, bytes);
      i.nodes.of(i.p.context, i.tree.nodes.size() * sizeof(BinaryNode));
    } else {
      i.triangles.of(i.p.context, bytes);
    }
    const auto start = Clock::now();
    if (through == Through::kBvh) {
      write<PackedTriangle>(i.p.queue, i.leaves.buffer, 0, i.in_leaves);
      write<BinaryNode>(i.p.queue, i.nodes.buffer, 0, i.tree.nodes);
    } else {
      write<PackedTriangle>(i.p.queue, i.triangles.buffer, 0, i.in_order);
    }
    i.p.queue.finish();
    return since(start);
  });
}

double OpenClRays::move(std::size_t first, std::span<const Triangle> triangles) {
  Impl& i = *impl_;
  if (first > i.in_order.size() || triangles.size() > i.in_order.size() - first)
    throw_usage("the moved triangles exceed the mesh");
  if (triangles.empty()) return 0;
  return guarded(i.p.facts.name, [&] {
    const auto start = Clock::now();
    for (std::size_t k = 0; k < triangles.size(); ++k)
      i.in_order[first + k] = packed(triangles[k], static_cast<std::uint32_t>(first + k));
    write<PackedTriangle>(i.p.queue, i.triangles.buffer, first,
                          std::span(i.in_order).subspan(first, triangles.size()));
    i.p.queue.finish();
    return since(start);
  });
}

std::vector<ClosestHit> OpenClRays::cast(std::span<const Ray> rays, Through through,
                                         OpenClTimes* times) {
  static_assert(sizeof(Ray) == 32 && sizeof(ClosestHit) == 8);
  Impl& i = *impl_;
  if (rays.empty()) return {};
  for (std::size_t k = 0; k < rays.size(); ++k)
    if (reference::bad(rays[k])) check(rays[k], fmt::format("ray {}", k));
  std::vector<ClosestHit> hits(rays.size());
  guarded(i.p.facts.name, [&] {
    i.rays.of(i.p.context, rays.size_bytes());
    i.hits.of(i.p.context, hits.size() * sizeof(ClosestHit));
    const auto start = Clock::now();
    write<Ray>(i.p.queue, i.rays.buffer, 0, rays);
    const std::vector<cl::Event> events = i.start(rays.size(), through);
    i.p.queue.enqueueReadBuffer(i.hits.buffer, CL_TRUE, 0, hits.size() * sizeof(ClosestHit),
                                hits.data());
    const double all = since(start);
    if (times == nullptr) return;
    times->copies += all;
    for (const cl::Event& event : events) times->kernel += OpenClProgram::seconds(event);
  });
  return hits;
}

struct OpenClSpheres::Impl {
  OpenClProgram p;
  cl::Kernel overlaps;
  OpenClBuffer spheres, found;
  explicit Impl(const OpenClDevice& device) : p(device) {
    guarded(p.facts.name, [&] { overlaps = cl::Kernel(p.program, "overlaps"); });
  }
};

OpenClSpheres::OpenClSpheres(const OpenClDevice& device) : impl_(std::make_unique<Impl>(device)) {}
OpenClSpheres::~OpenClSpheres() = default;

std::uint64_t OpenClSpheres::overlaps(std::span<const Sphere> spheres, OpenClTimes* times) {
  static_assert(sizeof(Sphere) == 16);
  Impl& i = *impl_;
  if (spheres.empty()) return 0;
  std::vector<cl_uint> found(spheres.size());
  guarded(i.p.facts.name, [&] {
    i.spheres.of(i.p.context, spheres.size_bytes());
    i.found.of(i.p.context, found.size() * sizeof(cl_uint));
    const auto start = Clock::now();
    write<Sphere>(i.p.queue, i.spheres.buffer, 0, spheres);
    i.overlaps.setArg(0, i.spheres.buffer);
    i.overlaps.setArg(1, static_cast<cl_uint>(spheres.size()));
    i.overlaps.setArg(2, i.found.buffer);
    const cl::Event event = i.p.start(i.overlaps, spheres.size());
    i.p.queue.enqueueReadBuffer(i.found.buffer, CL_TRUE, 0, found.size() * sizeof(cl_uint),
                                found.data());
    if (times != nullptr)
      times->copies += since(start), times->kernel += OpenClProgram::seconds(event);
  });
  return std::accumulate(found.begin(), found.end(), std::uint64_t{0});
}

}  // namespace cde::baseline

#else

namespace cde::baseline {
namespace {
[[noreturn]] void lacking() {
  throw_usage(
      "cde-bench was built without OpenCL; expected ocl-icd-opencl-dev and opencl-clhpp-headers "
      "(Debian: tools/setup programs) when it is built");
}
}  // namespace

struct OpenClRays::Impl {};
struct OpenClSpheres::Impl {};
bool has_opencl() {
  return false;
}
std::vector<OpenClDevice> opencl_devices() {
  lacking();
}
OpenClRays::OpenClRays(const OpenClDevice& /*device*/, std::span<const Triangle> /*triangles*/) {
  lacking();
}
OpenClRays::~OpenClRays() = default;
const OpenClRays::BvhFacts& OpenClRays::bvh() const {
  lacking();
}
double OpenClRays::upload(Through /*through*/) {
  lacking();
}
double OpenClRays::move(std::size_t /*first*/, std::span<const Triangle> /*triangles*/) {
  lacking();
}
std::vector<ClosestHit> OpenClRays::cast(std::span<const Ray> /*rays*/, Through /*through*/,
                                         OpenClTimes* /*times*/) {
  lacking();
}
OpenClSpheres::OpenClSpheres(const OpenClDevice& /*device*/) {
  lacking();
}
OpenClSpheres::~OpenClSpheres() = default;
std::uint64_t OpenClSpheres::overlaps(std::span<const Sphere> /*spheres*/, OpenClTimes* /*times*/) {
  lacking();
}

}  // namespace cde::baseline

#endif
