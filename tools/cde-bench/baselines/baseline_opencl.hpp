// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baselines/baseline.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/query/query.hpp"

/// OpenCL baselines: the queries of the other baselines on a GPU, or on another OpenCL device. The
/// kernels (opencl_queries.cl) compute T in the order of operations of the pipe.
namespace cde::baseline {

/// An OpenCL device, as its driver describes it.
struct OpenClDevice {
  std::string platform, name, driver, version;
  std::string kind;  ///< "GPU", "CPU", "accelerator" or "other"
  unsigned compute_units = 0;
  bool exact_division = false;  ///< division can be rounded correctly
  bool subnormals = false;      ///< keeps numbers below the normal ones
  std::size_t number = 0;       ///< in the list of all devices

  [[nodiscard]] bool is_gpu() const { return kind == "GPU"; }
  /// Whether T has the card's bits.
  [[nodiscard]] bool is_exact() const { return exact_division && subnormals; }
  /// "GPU NAME", "CPU NAME through OpenCL".
  [[nodiscard]] std::string label() const;
  /// "GPU", "CPU through OpenCL".
  [[nodiscard]] std::string short_label() const;
};

/// Whether this program was built with OpenCL. Otherwise the functions below throw Error kUsage,
/// which names the missing packages.
[[nodiscard]] bool has_opencl();

/// All devices of all platforms, at least one. Error kUsage, naming what is missing, without any.
[[nodiscard]] std::vector<OpenClDevice> opencl_devices();

/// The device whose number is `words`, or whose name or platform contains `words` (in either case).
/// An empty text chooses the first GPU, else the first device. Error kUsage, with the list, if none
/// or several fit.
[[nodiscard]] OpenClDevice choose_opencl_device(std::span<const OpenClDevice> devices,
                                                std::string_view words);

/// Times of a cast, in seconds.
struct OpenClTimes {
  double upload = 0;  ///< wall time: triangles, and nodes of the BVH, to the device
  double kernel = 0;  ///< of the device, by its profiling events
  double copies = 0;  ///< wall time: rays to the device, kernels, hits to the host
};

/// Triangles on an OpenCL device, and casts of rays at them. Errors of OpenCL are Error kCapacity
/// (out of memory), kBuild (the compiler's messages) or kDevice.
class OpenClRays {
 public:
  /// Compiles the kernels and builds the BVH. Error kBadInput, with its number, for a triangle out
  /// of the input contract, and without triangles.
  OpenClRays(const OpenClDevice& device, std::span<const Triangle> triangles);
  ~OpenClRays();
  OpenClRays(const OpenClRays&) = delete;
  OpenClRays& operator=(const OpenClRays&) = delete;

  /// Figures of the BVH. The build took processor time of one thread.
  struct BvhFacts {
    std::size_t nodes = 0, bytes = 0;
    unsigned levels = 0;
    double build_seconds = 0;
  };
  [[nodiscard]] const BvhFacts& bvh() const;

  /// Uploads everything that casts `through` need: kBvh or kBruteForce. Returns seconds.
  double upload(Through through);
  /// Replaces triangles from `first` on, for brute force only. Returns seconds.
  double move(std::size_t first, std::span<const Triangle> triangles);
  /// The nearest hit of every ray, ties to the lowest index, with the box rule. upload() must have
  /// been called. Error kBadInput, with its number, for a ray out of the input contract.
  [[nodiscard]] std::vector<ClosestHit> cast(std::span<const Ray> rays, Through through,
                                             OpenClTimes* times = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Counts overlaps of spheres on an OpenCL device.
class OpenClSpheres {
 public:
  explicit OpenClSpheres(const OpenClDevice& device);
  ~OpenClSpheres();
  OpenClSpheres(const OpenClSpheres&) = delete;
  OpenClSpheres& operator=(const OpenClSpheres&) = delete;

  /// The number of ordered pairs that overlap or touch, including each sphere with itself.
  /// Adds the seconds of this frame: spheres to the device (upload), kernel, and all (copies).
  [[nodiscard]] std::uint64_t overlaps(std::span<const Sphere> spheres,
                                       OpenClTimes* times = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cde::baseline
