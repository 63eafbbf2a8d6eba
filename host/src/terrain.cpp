#include "cde/terrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include "cde/error.hpp"

// Broad shapes come from gradient noise, ridges and valleys from a landscape evolution model:
// uplift against rivers that cut by stream power (slope times the square root of the drained area),
// after Braun and Willett 2013, with lakes filled by a priority flood, after Barnes et al. 2014.
// Only + - * / and sqrt of binary64, so every compiler makes the same bits.
namespace cde {
namespace {

constexpr double kSpacing = 10.0;  // metres a quad
constexpr double kTop = 360.0;     // metres, the highest vertex
constexpr std::uint32_t kMostQuads = 4096;

/// Integer noise: the 64-bit finaliser of SplitMix.
std::uint64_t scramble(std::uint64_t h) {
  h += 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

/// Gradient noise in about -1 to 1, one lattice cell a unit; x and y not negative.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : seed_(scramble(seed)) {}

  [[nodiscard]] double at(double x, double y) const {
    const auto i = static_cast<std::uint64_t>(x);
    const auto j = static_cast<std::uint64_t>(y);
    const double fx = x - static_cast<double>(i);
    const double fy = y - static_cast<double>(j);
    const double u = fade(fx);
    const double v = fade(fy);
    const double low =
        corner(i, j, fx, fy) + u * (corner(i + 1, j, fx - 1.0, fy) - corner(i, j, fx, fy));
    const double high =
        corner(i, j + 1, fx, fy - 1.0) +
        u * (corner(i + 1, j + 1, fx - 1.0, fy - 1.0) - corner(i, j + 1, fx, fy - 1.0));
    return 1.5 * (low + v * (high - low));
  }

  /// Octaves of twice the frequency and half the height.
  [[nodiscard]] double fractal(double x, double y, int octaves) const {
    double sum = 0.0;
    double height = 1.0;
    for (int octave = 0; octave < octaves; ++octave) {
      sum += height * at(x, y);
      height *= 0.5;
      // An offset, so that the lattice points of the octaves do not fall together.
      x = 2.0 * x + 17.37;
      y = 2.0 * y + 41.83;
    }
    return sum;
  }

 private:
  static double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

  [[nodiscard]] double corner(std::uint64_t i, std::uint64_t j, double dx, double dy) const {
    const std::uint64_t h = scramble(scramble(seed_ ^ i) ^ j);
    const double gx = static_cast<double>(h >> 43) * 0x1p-20 - 1.0;
    const double gy = static_cast<double>(h & 0x1fffffu) * 0x1p-20 - 1.0;
    return gx * dx + gy * dy;
  }

  std::uint64_t seed_;
};

class Landscape {
 public:
  explicit Landscape(const TerrainOptions& options)
      : columns_(options.quads_x + 1 + 2 * kApron),
        rows_(options.quads_y + 1 + 2 * kApron),
        cells_(std::size_t{columns_} * rows_) {
    shape(options.seed);
    for (int step = 0; step < kSteps; ++step) {
      flood();
      drain();
      erode();
      creep(0.20);
    }
    flood();
    for (int pass = 0; pass < 3; ++pass) creep(0.15);
    roughen(options.seed);
    crop();
    level();
  }

  [[nodiscard]] const std::vector<double>& heights() const { return height_; }

 private:
  // The model drains at its edges, so they lie low and straight. An apron keeps them out of the
  // mesh.
  static constexpr std::uint32_t kApron = 40;
  static constexpr int kSteps = 16;
  static constexpr double kUplift = 30.0;  // metres a step where the ground rises fastest
  static constexpr double kCutting =
      1.35;  // erodibility times step length, per metre of sqrt(drained area)

  static constexpr double kRepose = 0.65;  // steepest slope that stands

  [[nodiscard]] bool is_edge(std::size_t cell) const {
    const std::size_t x = cell % columns_;
    const std::size_t y = cell / columns_;
    return x == 0 || y == 0 || x + 1 == columns_ || y + 1 == rows_;
  }

  void shape(std::uint64_t seed) {
    const Noise broad(3 * seed);
    const Noise warp(3 * seed + 1);
    height_.resize(cells_);
    uplift_.resize(cells_);
    for (std::size_t cell = 0; cell < cells_; ++cell) {
      double x = static_cast<double>(cell % columns_) * kSpacing / 1700.0 + 8.0;
      double y = static_cast<double>(cell / columns_) * kSpacing / 1700.0 + 8.0;
      x += 0.35 * warp.fractal(1.3 * x, 1.3 * y, 3);
      y += 0.35 * warp.fractal(1.3 * x + 70.0, 1.3 * y, 3);
      const double n = 0.5 + 0.5 * broad.fractal(x, y, 6);
      const double massif =
          std::clamp(0.42 + 0.95 * broad.fractal(0.8 * x + 31.0, 0.8 * y + 31.0, 3), 0.06, 1.0);
      height_[cell] = 120.0 * n;
      uplift_[cell] = massif * (0.4 + 0.6 * n);
    }
  }

  template <typename Visit>
  void neighbours(std::size_t cell, Visit visit) const {
    constexpr double kDiagonal = 1.4142135623730951;
    const auto x = static_cast<std::int64_t>(cell % columns_);
    const auto y = static_cast<std::int64_t>(cell / columns_);
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= columns_ ||
            y + dy >= rows_)
          continue;
        const auto other = static_cast<std::size_t>((y + dy) * columns_ + x + dx);
        visit(other, (dx != 0 && dy != 0 ? kDiagonal : 1.0) * kSpacing);
      }
    }
  }

  /// Raises hollows to their outlets, and leaves the cells in order_ from low to high with a way
  /// down for each.
  void flood() {
    constexpr double kLeastFall = 0.002;  // metres, so that water crosses a filled lake
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> shore;
    std::vector<char> seen(cells_, 0);
    order_.clear();
    downstream_.resize(cells_);
    for (std::size_t cell = 0; cell < cells_; ++cell) {
      if (!is_edge(cell)) continue;
      seen[cell] = 1;
      downstream_[cell] = cell;
      shore.emplace(height_[cell], cell);
    }
    while (!shore.empty()) {
      const std::size_t cell = shore.top().second;
      shore.pop();
      order_.push_back(cell);
      neighbours(cell, [&](std::size_t other, double) {
        if (seen[other] != 0) return;
        seen[other] = 1;
        downstream_[other] = cell;
        height_[other] = std::max(height_[other], height_[cell] + kLeastFall);
        shore.emplace(height_[other], other);
      });
    }
  }

  /// Steepest way down from each cell, and the area that drains through it.
  void drain() {
    area_.assign(cells_, kSpacing * kSpacing);
    for (const std::size_t cell : order_) {
      if (is_edge(cell)) continue;
      double steepest = 0.0;
      neighbours(cell, [&](std::size_t other, double distance) {
        const double fall = (height_[cell] - height_[other]) / distance;
        if (fall > steepest) {
          steepest = fall;
          downstream_[cell] = other;
        }
      });
    }
    for (auto cell = order_.rbegin(); cell != order_.rend(); ++cell) {
      if (downstream_[*cell] != *cell) area_[downstream_[*cell]] += area_[*cell];
    }
  }

  /// One implicit step of uplift and river cutting, from the outlets upwards; stable for any step
  /// length.
  void erode() {
    for (const std::size_t cell : order_) {
      const std::size_t down = downstream_[cell];
      if (down == cell) continue;
      const bool diagonal =
          cell % columns_ != down % columns_ && cell / columns_ != down / columns_;
      const double distance = diagonal ? kSpacing * 1.4142135623730951 : kSpacing;
      const double cut = kCutting * std::sqrt(area_[cell]) / distance;
      height_[cell] = (height_[cell] + kUplift * uplift_[cell] + cut * height_[down]) / (1.0 + cut);
      height_[cell] = std::min(height_[cell], height_[down] + kRepose * distance);  // scree slides
    }
  }

  /// Soil creep: each cell moves towards the mean of its four neighbours.
  void creep(double rate) {
    scratch_ = height_;
    for (std::size_t y = 0; y < rows_; ++y) {
      for (std::size_t x = 0; x < columns_; ++x) {
        const std::size_t cell = y * columns_ + x;
        const double west = scratch_[x > 0 ? cell - 1 : cell];
        const double east = scratch_[x + 1 < columns_ ? cell + 1 : cell];
        const double south = scratch_[y > 0 ? cell - columns_ : cell];
        const double north = scratch_[y + 1 < rows_ ? cell + columns_ : cell];
        height_[cell] += rate * (west + east + south + north - 4.0 * scratch_[cell]);
      }
    }
  }

  /// Boulders and gullies too small for the model.
  void roughen(std::uint64_t seed) {
    const Noise fine(3 * seed + 2);
    for (std::size_t cell = 0; cell < cells_; ++cell) {
      const double x = static_cast<double>(cell % columns_) * kSpacing / 90.0;
      const double y = static_cast<double>(cell / columns_) * kSpacing / 90.0;
      height_[cell] += (0.8 + 4.0 * uplift_[cell]) * fine.fractal(x, y, 3);
    }
  }

  void crop() {
    scratch_.swap(height_);
    height_.clear();
    for (std::size_t y = kApron; y + kApron < rows_; ++y) {
      const auto row = scratch_.begin() + static_cast<std::ptrdiff_t>(y * columns_);
      height_.insert(height_.end(), row + kApron, row + (columns_ - kApron));
    }
  }

  void level() {
    const auto [low, high] = std::minmax_element(height_.begin(), height_.end());
    const double bottom = *low;
    const double range = *high - bottom;
    // A terrain of very few quads may be flat.
    for (double& h : height_) h = range > 0.0 ? (h - bottom) / range * kTop : 0.0;
  }

  std::uint32_t columns_;
  std::uint32_t rows_;
  std::size_t cells_;
  std::vector<double> height_;
  std::vector<double> uplift_;  // 0 to 1
  std::vector<double> area_;    // square metres
  std::vector<double> scratch_;
  std::vector<std::size_t> order_;
  std::vector<std::size_t> downstream_;  // itself at the edge
};

}  // namespace

Mesh make_terrain(const TerrainOptions& options) {
  const auto in_range = [](std::uint32_t n) { return n >= 1 && n <= kMostQuads; };
  if (!in_range(options.quads_x) || !in_range(options.quads_y)) {
    throw Error(ErrorCode::kUsage, fmt::format("terrain of {} x {} quads: each must be 1 to {}",
                                               options.quads_x, options.quads_y, kMostQuads));
  }
  const Landscape landscape(options);
  const std::vector<double>& heights = landscape.heights();
  const std::uint32_t columns = options.quads_x + 1;
  Mesh mesh;
  mesh.name = "terrain";
  mesh.vertices.reserve(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    mesh.vertices.emplace_back(static_cast<float>(static_cast<double>(i % columns) * kSpacing),
                               static_cast<float>(static_cast<double>(i / columns) * kSpacing),
                               static_cast<float>(heights[i]));
  }
  mesh.faces.reserve(std::size_t{2} * options.quads_x * options.quads_y);
  for (std::uint32_t y = 0; y < options.quads_y; ++y) {
    for (std::uint32_t x = 0; x < options.quads_x; ++x) {
      const std::uint32_t sw = y * columns + x;
      const std::uint32_t se = sw + 1;
      const std::uint32_t nw = sw + columns;
      const std::uint32_t ne = nw + 1;
      // Along the diagonal that falls less, so that ridges and valley floors are edges and not saw
      // teeth.
      if (std::fabs(heights[sw] - heights[ne]) <= std::fabs(heights[se] - heights[nw])) {
        mesh.faces.push_back({sw, se, ne});
        mesh.faces.push_back({sw, ne, nw});
      } else {
        mesh.faces.push_back({sw, se, nw});
        mesh.faces.push_back({se, ne, nw});
      }
    }
  }
  return mesh;
}

}  // namespace cde
