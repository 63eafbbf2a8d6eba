// SPDX-License-Identifier: Apache-2.0
#include "cde/mesh/terrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>

#include "cde/support/error.hpp"

// Makes a terrain. Gradient noise gives the broad shapes. A landscape evolution model gives ridges
// and valleys: it sets uplift against rivers. They cut by stream power, which is slope times the
// square root of the drained area (Braun and Willett 2013). A priority flood fills the lakes
// (Barnes et al. 2014). The code uses only + - * / and sqrt of binary64, so every compiler gets the
// same bits.
namespace cde {
namespace {

constexpr double kSpacing = 10.0;  // metres per quad
constexpr double kTop = 360.0;     // metres, the highest vertex
constexpr std::uint32_t kMostQuads = 4096;

/// Integer noise: the 64-bit finaliser of SplitMix.
std::uint64_t scramble(std::uint64_t h) {
  h += 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

/// Gradient noise of about -1 to 1, with one lattice cell per unit; x and y are not negative.
/// Successive points are close together, so the gradients around the last point are kept.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : seed_(scramble(seed)) {}

  /// Sums octaves of twice the frequency and half the height each; at most kMost.
  [[nodiscard]] double fractal(double x, double y, int octaves) {
    double sum = 0.0;
    double height = 1.0;
    for (int octave = 0; octave < octaves; ++octave) {
      sum += height * at(x, y, cells_[static_cast<std::size_t>(octave)]);
      height *= 0.5;
      // The offset keeps lattice points of the octaves apart.
      x = 2.0 * x + 17.37;
      y = 2.0 * y + 41.83;
    }
    return sum;
  }

 private:
  static constexpr std::size_t kMost = 6;
  struct Gradient {
    double x, y;
  };
  /// A cell of the lattice with the gradients of its corners.
  struct Cell {
    std::uint64_t i = ~std::uint64_t{0}, j = ~std::uint64_t{0};
    Gradient corner[2][2] = {};  // [j][i]
  };

  [[nodiscard]] double at(double x, double y, Cell& cell) const {
    const auto i = static_cast<std::uint64_t>(x);
    const auto j = static_cast<std::uint64_t>(y);
    if (i != cell.i || j != cell.j) enter(cell, i, j);
    const double fx = x - static_cast<double>(i);
    const double fy = y - static_cast<double>(j);
    const double u = fade(fx);
    const double v = fade(fy);
    const auto slope = [](const Gradient& g, double dx, double dy) { return g.x * dx + g.y * dy; };
    const auto& c = cell.corner;
    const double south_west = slope(c[0][0], fx, fy), north_west = slope(c[1][0], fx, fy - 1.0);
    const double low = south_west + u * (slope(c[0][1], fx - 1.0, fy) - south_west);
    const double high = north_west + u * (slope(c[1][1], fx - 1.0, fy - 1.0) - north_west);
    return 1.5 * (low + v * (high - low));
  }

  void enter(Cell& cell, std::uint64_t i, std::uint64_t j) const {
    cell.i = i;
    cell.j = j;
    for (std::uint64_t di = 0; di < 2; ++di) {
      const std::uint64_t column = scramble(seed_ ^ (i + di));
      for (std::uint64_t dj = 0; dj < 2; ++dj) {
        const std::uint64_t h = scramble(column ^ (j + dj));
        cell.corner[dj][di] = {static_cast<double>(h >> 43) * 0x1p-20 - 1.0,
                               static_cast<double>(h & 0x1fffffu) * 0x1p-20 - 1.0};
      }
    }
  }

  static double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

  std::uint64_t seed_;
  Cell cells_[kMost];
};

/// A queue of cells by height, lowest first; equal heights come in any order. The heights taken
/// never decrease. So cells are sorted roughly into buckets, and exactly only in the current
/// bucket.
class Shore {
 public:
  Shore(double lowest, double highest)
      : lowest_(lowest), scale_((kBuckets - 1) / std::max(highest - lowest, 1e-9)) {}

  void add(double height, std::uint32_t cell) {
    const std::size_t bucket = std::max(
        current_,
        std::min<std::size_t>(kBuckets - 1, static_cast<std::size_t>((height - lowest_) * scale_)));
    if (bucket == current_ && sorting_)
      sorted_.emplace(height, cell);
    else
      buckets_[bucket].emplace_back(height, cell);
  }
  /// False if no cell remains.
  bool take(std::uint32_t& cell) {
    while (sorted_.empty()) {
      if (sorting_ && ++current_ == kBuckets) return false;
      sorting_ = true;
      sorted_ = Sorted({}, std::move(buckets_[current_]));
    }
    cell = sorted_.top().second;
    sorted_.pop();
    return true;
  }

 private:
  static constexpr std::size_t kBuckets = 16384;
  using Entry = std::pair<double, std::uint32_t>;
  using Sorted = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;
  double lowest_, scale_;
  std::size_t current_ = 0;
  bool sorting_ = false;  // the current bucket is in sorted_
  Sorted sorted_;
  std::vector<std::vector<Entry>> buckets_{kBuckets};
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
  // The model drains at its edges, so they lie low and straight. An apron keeps the edges out of
  // the mesh.
  static constexpr std::uint32_t kApron = 40;
  static constexpr int kSteps = 16;
  static constexpr double kUplift = 30.0;  // metres per step where the ground rises fastest
  static constexpr double kCutting =
      1.35;  // erodibility times step length, per metre of sqrt(drained area)

  static constexpr double kRepose = 0.65;  // steepest stable slope

  using Index = std::uint32_t;  // number of a cell; at most 4177 x 4177 cells

  template <typename Visit>
  void for_each_edge(Visit visit) const {
    for (Index x = 0; x < columns_; ++x) visit(x), visit((rows_ - 1) * columns_ + x);
    for (Index y = 1; y + 1 < rows_; ++y) visit(y * columns_), visit(y * columns_ + columns_ - 1);
  }

  /// Offsets of the neighbours in the order in which ties are broken, and which are diagonal.
  [[nodiscard]] std::array<std::int64_t, 8> around() const {
    const std::int64_t row = columns_;
    return {-row - 1, -row, -row + 1, -1, 1, row - 1, row, row + 1};
  }
  static constexpr std::array<bool, 8> kIsDiagonal = {true,  false, true,  false,
                                                      false, true,  false, true};

  void shape(std::uint64_t seed) {
    Noise broad(3 * seed), massifs(3 * seed), warp_x(3 * seed + 1), warp_y(3 * seed + 1);
    height_.resize(cells_);
    uplift_.resize(cells_);
    std::size_t cell = 0;
    for (std::uint32_t row = 0; row < rows_; ++row) {
      for (std::uint32_t column = 0; column < columns_; ++column, ++cell) {
        double x = static_cast<double>(column) * kSpacing / 1700.0 + 8.0;
        double y = static_cast<double>(row) * kSpacing / 1700.0 + 8.0;
        x += 0.35 * warp_x.fractal(1.3 * x, 1.3 * y, 3);
        y += 0.35 * warp_y.fractal(1.3 * x + 70.0, 1.3 * y, 3);
        const double n = 0.5 + 0.5 * broad.fractal(x, y, 6);
        const double massif =
            std::clamp(0.42 + 0.95 * massifs.fractal(0.8 * x + 31.0, 0.8 * y + 31.0, 3), 0.06, 1.0);
        height_[cell] = 120.0 * n;
        uplift_[cell] = massif * (0.4 + 0.6 * n);
      }
    }
  }

  /// Raises hollows to their outlets. An inner cell below its lowest neighbour is raised to just
  /// above that neighbour. Climbing from finished cells finds all cells that are high enough
  /// already, in any order. Only the shores of hollows wait in a queue, lowest first.
  void flood() {
    constexpr double kLeastFall = 0.002;  // metres, so that water crosses a filled lake
    const auto [low, high] = std::minmax_element(height_.begin(), height_.end());
    Shore shore(*low, *high);
    finished_.assign(cells_, 0);
    std::vector<Index> climbing, doubtful;
    const auto finish = [&](Index cell) {
      finished_[cell] = 1;
      climbing.push_back(cell);
    };
    const auto offsets = around();
    const auto climb = [&] {
      while (!climbing.empty()) {
        const Index cell = climbing.back();
        climbing.pop_back();
        const double least = height_[cell] + kLeastFall;
        bool is_doubtful = false;
        neighbours(cell, offsets, [&](Index other) {
          if (finished_[other] != 0) return;
          if (height_[other] >= least)
            finish(other);
          else
            is_doubtful = true;
        });
        if (is_doubtful) doubtful.push_back(cell);
      }
      // Most lower neighbours have been reached from elsewhere since.
      for (const Index cell : doubtful) {
        bool is_shore = false;
        neighbours(cell, offsets, [&](Index other) { is_shore |= finished_[other] == 0; });
        if (is_shore) shore.add(height_[cell], cell);
      }
      doubtful.clear();
    };
    for_each_edge(finish);
    climb();
    for (Index cell = 0; shore.take(cell);) {
      neighbours(cell, offsets, [&](Index other) {
        if (finished_[other] != 0) return;
        height_[other] = std::max(height_[other], height_[cell] + kLeastFall);
        finish(other);
      });
      climb();
    }
  }

  /// Visits the neighbours that are not edges: edges are finished from the start.
  template <typename Visit>
  void neighbours(Index cell, const std::array<std::int64_t, 8>& offsets, Visit visit) const {
    for (const std::int64_t offset : offsets) {
      const std::int64_t other = std::int64_t{cell} + offset;
      // Beyond the left or right edge lies an edge cell of another row, which is also finished.
      if (other >= 0 && other < static_cast<std::int64_t>(cells_)) visit(static_cast<Index>(other));
    }
  }

  /// Finds the steepest descent from each cell and the area that drains through it. Puts upstream
  /// cells before downstream cells into order_.
  void drain() {
    constexpr double kDiagonal = 1.4142135623730951;
    const auto offsets = around();
    downstream_.resize(cells_);
    std::vector<std::uint8_t> springs(cells_, 0);  // neighbours that drain into a cell
    for_each_edge([&](Index cell) { downstream_[cell] = cell; });
    for (Index y = 1; y + 1 < rows_; ++y) {
      for (Index cell = y * columns_ + 1; cell + 1 < (y + 1) * columns_; ++cell) {
        double steepest = 0.0;
        Index down = cell;
        for (std::size_t k = 0; k < offsets.size(); ++k) {
          const auto other = static_cast<Index>(cell + offsets[k]);
          const double fall =
              (height_[cell] - height_[other]) / ((kIsDiagonal[k] ? kDiagonal : 1.0) * kSpacing);
          if (fall > steepest) {
            steepest = fall;
            down = other;
          }
        }
        downstream_[cell] = down;
        ++springs[down];
      }
    }
    // Areas are integers, so their sums are exact in any order.
    area_.assign(cells_, kSpacing * kSpacing);
    order_.clear();
    for (Index start = 0; start < cells_; ++start) {
      if (springs[start] != 0 || downstream_[start] == start) continue;
      for (Index cell = start;;) {
        const Index down = downstream_[cell];
        order_.push_back(cell);
        springs[cell] = 1;  // not again
        area_[down] += area_[cell];
        if (--springs[down] != 0 || downstream_[down] == down) break;
        cell = down;
      }
    }
  }

  /// One implicit step of uplift and river cutting, from the outlets upwards. It is stable for any
  /// step length.
  void erode() {
    for (auto at = order_.rbegin(); at != order_.rend(); ++at) {
      const Index cell = *at, down = downstream_[cell];
      const Index apart = cell < down ? down - cell : cell - down;
      const bool diagonal = apart != 1 && apart != columns_;
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

  /// Adds boulders and gullies that are too small for the model.
  void roughen(std::uint64_t seed) {
    Noise fine(3 * seed + 2);
    std::size_t cell = 0;
    for (std::uint32_t row = 0; row < rows_; ++row) {
      const double y = static_cast<double>(row) * kSpacing / 90.0;
      for (std::uint32_t column = 0; column < columns_; ++column, ++cell) {
        const double x = static_cast<double>(column) * kSpacing / 90.0;
        height_[cell] += (0.8 + 4.0 * uplift_[cell]) * fine.fractal(x, y, 3);
      }
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
  std::vector<char> finished_;
  std::vector<Index> order_;
  std::vector<Index> downstream_;  // a cell at the edge drains into itself
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
  for (std::uint32_t y = 0; y <= options.quads_y; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      mesh.vertices.emplace_back(static_cast<float>(static_cast<double>(x) * kSpacing),
                                 static_cast<float>(static_cast<double>(y) * kSpacing),
                                 static_cast<float>(heights[std::size_t{y} * columns + x]));
    }
  }
  mesh.faces.reserve(std::size_t{2} * options.quads_x * options.quads_y);
  for (std::uint32_t y = 0; y < options.quads_y; ++y) {
    for (std::uint32_t x = 0; x < options.quads_x; ++x) {
      const std::uint32_t sw = y * columns + x;
      const std::uint32_t se = sw + 1;
      const std::uint32_t nw = sw + columns;
      const std::uint32_t ne = nw + 1;
      // Cuts along the diagonal that falls less, so that ridges and valley floors become edges, not
      // saw teeth.
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
