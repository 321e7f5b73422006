#include "core/photometry/sphere_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/photometry/shapes/arc_tangent.h"

namespace luxrig {
namespace {

// Rounding must not darken a direction at the first or last angle.
constexpr double kRounding_rad = 1e-9;
// Widest piece for which the series below are good to 1e-15.
constexpr double kWidestPiece_rad = 0.05;
// Shares are kept off the ends, where a value of 0 would give a direction of density 0.
constexpr double kMinShare = 1e-12;
// Values below this share of the largest count as dark: the squares of smaller ones would underflow to 0 / 0.
constexpr double kFaintest = 1e-60;
constexpr double kMinPeak = 1e-60, kMaxPeak = 1e60;

/// sin x - x and 1 - cos x for small x, without cancellation.
struct Small {
  explicit Small(double x)
      : sine_excess(-x * x * x * (1.0 / 6 - x * x * (1.0 / 120 - x * x * (1.0 / 5040 - x * x / 362880)))),
        sine(x + sine_excess),
        versine(x * x * (0.5 - x * x * (1.0 / 24 - x * x * (1.0 / 720 - x * x / 40320)))) {}
  double sine_excess, sine, versine;
};

constexpr int kTurnSteps = 128;
const auto kTurns = [] {
  std::array<std::array<double, 2>, kTurnSteps> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / kTurnSteps;
    table[k] = {std::sin(angle), std::cos(angle)};
  }
  return table;
}();

/// Sine and cosine of `turns` times 2π, |turns| ≤ 2: from a table and the series, in a third of the library's time.
struct Turn {
  explicit Turn(double turns) {
    constexpr int kAbove0 = 4 * kTurnSteps;
    const int k = static_cast<int>(turns * kTurnSteps + (kAbove0 + 0.5)) - kAbove0;
    const auto& [sin_k, cos_k] = kTurns[static_cast<std::size_t>(k & (kTurnSteps - 1))];
    const Small small(2 * kPi * (turns - static_cast<double>(k) / kTurnSteps));
    sine = sin_k + cos_k * small.sine - sin_k * small.versine;
    cosine = cos_k - sin_k * small.sine - cos_k * small.versine;
  }
  double sine, cosine;
};

/// Position 0…1 in a cell at which a share s of its integral is reached; the density is linear from a to b.
double linear_place(double a, double b, double s) {
  return s * (a + b) / (a + std::sqrt(std::max(0.0, a * a + s * (b * b - a * a))));
}

int copies(SphereTable::Symmetry symmetry) {
  switch (symmetry) {
    case SphereTable::Symmetry::quadrant:
      return 4;
    case SphereTable::Symmetry::half_0_180:
    case SphereTable::Symmetry::half_90_270:
      return 2;
    default:
      return 1;
  }
}

}  // namespace

Ascending::Ascending(std::vector<double> knots) : knots_(std::move(knots)) {
  LUXRIG_CHECK(knots_.size() >= 2 && knots_.back() > knots_.front(), "{} knots", knots_.size());
  const double range = knots_.back() - knots_.front();
  const double step = range / static_cast<double>(knots_.size() - 1);
  bool even = true;
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    even = even && std::abs(knots_[i] - (knots_.front() + step * static_cast<double>(i))) <= 1e-9 * step;
  }
  if (even) inverse_step_ = 1 / step;
  // Enough buckets that no two knots share one, if possible. One comparison then finds the interval.
  double min_gap = range;
  for (std::size_t i = 1; i < knots_.size(); ++i) min_gap = std::min(min_gap, knots_[i] - knots_[i - 1]);
  const double wanted = std::ceil(1.001 * range / std::max(min_gap, 1e-6 * range));
  one_each_ = wanted <= 4096;
  const std::size_t buckets = one_each_ ? static_cast<std::size_t>(wanted) : 2 * knots_.size();
  buckets_per_unit_ = static_cast<double>(buckets) / range;
  guide_.resize(buckets + 1);
  std::size_t at = 0;
  for (std::size_t b = 0; b <= buckets; ++b) {
    const double start = knots_.front() + range * static_cast<double>(b) / static_cast<double>(buckets);
    while (at + 2 < knots_.size() && knots_[at + 1] <= start) ++at;
    guide_[b] = static_cast<std::uint32_t>(at);
  }
}

std::size_t Ascending::interval(double x) const {
  const std::size_t last = knots_.size() - 2;
  const double offset =
      std::clamp((x - knots_.front()) * buckets_per_unit_, 0.0, static_cast<double>(guide_.size() - 2));
  const std::size_t bucket = static_cast<std::size_t>(offset);
  std::size_t i = guide_[bucket];
  if (one_each_) return std::min(last, i + static_cast<std::size_t>(knots_[i + 1] <= x));
  if (guide_[bucket + 1] - i > 16) {
    const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x);
    return static_cast<std::size_t>(above - knots_.begin()) - 1;
  }
  while (i < last && knots_[i + 1] <= x) ++i;
  return i;
}

Ascending::Cell Ascending::cell(double x) const {
  if (inverse_step_ > 0) {
    const double position = std::max(0.0, (x - knots_.front()) * inverse_step_);
    const std::size_t index = std::min(knots_.size() - 2, static_cast<std::size_t>(position));
    return {index, std::min(1.0, position - static_cast<double>(index))};
  }
  const std::size_t i = interval(x);
  const double width = knots_[i + 1] - knots_[i];
  return {i, width > 0 ? std::clamp((x - knots_[i]) / width, 0.0, 1.0) : 0.0};
}

SphereTable::SphereTable(Symmetry symmetry, std::vector<double> polar_rad, std::vector<double> azimuth_rad,
                         std::vector<double> values)
    : symmetry_(symmetry), polar_(std::move(polar_rad)), values_(std::move(values)) {
  const std::size_t polars = polar_.knots().size();
  if (symmetry_ == Symmetry::round) azimuth_rad = {0, 2 * kPi};
  azimuth_ = Ascending(std::move(azimuth_rad));
  const std::size_t columns = symmetry_ == Symmetry::round ? 1 : azimuth_.knots().size();
  LUXRIG_CHECK(values_.size() == polars * columns, "{} values for {} x {} angles", values_.size(), columns, polars);
  largest_ = *std::max_element(values_.begin(), values_.end());
  LUXRIG_CHECK(largest_ >= kMinPeak && largest_ <= kMaxPeak, "largest value {}", largest_);
  for (double& value : values_) value = value < kFaintest * largest_ ? 0 : value;

  const auto& azimuth = azimuth_.knots();
  std::vector<double> ring(polars);
  if (symmetry_ == Symmetry::round) {
    for (std::size_t p = 0; p < polars; ++p) ring[p] = 2 * kPi * values_[p];
  } else {
    rings_.assign(polars * columns, 0.0);
    for (std::size_t p = 0; p < polars; ++p) {
      for (std::size_t a = 1; a < columns; ++a) {
        rings_[p * columns + a] =
            rings_[p * columns + a - 1] + 0.5 * (azimuth[a] - azimuth[a - 1]) * (value(a - 1, p) + value(a, p));
      }
      ring[p] = rings_[p * columns + columns - 1];
    }
  }
  for (std::size_t p = 0; p + 1 < polars; ++p) add_pieces(p, ring[p], ring[p + 1]);

  double sum = 0;
  for (const Piece& piece : pieces_) sum += piece.integral;
  integral_ = sum * copies(symmetry_);
  LUXRIG_CHECK(integral_ > 0 && std::isfinite(integral_), "integral {}", integral_);
  // Pieces that would be lost in the rounding of the sum are never sampled.
  std::erase_if(pieces_, [sum](const Piece& piece) { return piece.integral < 1e-14 * sum; });
  std::vector<double> cumulative{0};
  for (const Piece& piece : pieces_) cumulative.push_back(cumulative.back() + piece.integral / sum);
  cumulative_ = Ascending(std::move(cumulative));
}

void SphereTable::add_pieces(std::size_t band, double ring_lower, double ring_upper) {
  const double from = polar_.knots()[band];
  const double width = polar_.knots()[band + 1] - from;
  // A band that is dark at one end and has a pole at the other has density 0 at both, so its middle is needed.
  const int fewest = ring_lower > 0 && ring_upper > 0 ? 1 : 2;
  const int count = std::max(fewest, static_cast<int>(std::ceil(width / kWidestPiece_rad)));
  const double slope = (ring_upper - ring_lower) / width;
  for (int i = 0; i < count; ++i) {
    Piece piece{};
    piece.start_rad = from + width * i / count;
    piece.sin_start = std::sin(piece.start_rad);
    piece.cos_start = std::cos(piece.start_rad);
    piece.value = ring_lower + (ring_upper - ring_lower) * i / count;
    piece.slope = slope;
    piece.width_rad = width / count;
    piece.band = static_cast<std::uint32_t>(band);
    const double x = piece.width_rad;
    const Small small(x);
    piece.integral = piece.value * (piece.sin_start * small.sine + piece.cos_start * small.versine) +
                     slope * (piece.sin_start * (x * small.sine - small.versine) +
                              piece.cos_start * (small.sine_excess + x * small.versine));
    piece.density_start = std::max(0.0, piece.value * piece.sin_start);
    piece.density_end = std::max(0.0, (piece.value + slope * x) * (piece.sin_start + piece.cos_start * small.sine -
                                                                   piece.sin_start * small.versine));
    const auto [least, most] = std::minmax(piece.density_start, piece.density_end);
    piece.gentle = most < 4 * least;
    if (piece.integral > 0 && most > 0) pieces_.push_back(piece);
  }
}

double SphereTable::folded_azimuth_rad(const Vec3& d) const {
  switch (symmetry_) {
    case Symmetry::round:
      return 0;
    case Symmetry::quadrant:
      return angle_rad(std::abs(d.y()), std::abs(d.x()));
    case Symmetry::half_0_180:
      return angle_rad(std::abs(d.y()), d.x());
    case Symmetry::half_90_270:  // from +Y (90°) over -X to -Y (270°)
      return kPi - std::copysign(angle_rad(std::abs(d.y()), std::abs(d.x())), d.y());
    case Symmetry::none:
      return kPi - std::copysign(kPi - angle_rad(std::abs(d.y()), d.x()), d.y());
    case Symmetry::part:
      break;
  }
  return std::copysign(angle_rad(std::abs(d.y()), d.x()), d.y());
}

double SphereTable::at(const Vec3& d) const {
  const double angle = angle_rad(std::sqrt(d.x() * d.x() + d.y() * d.y()), d.z());
  const auto& polar = polar_.knots();
  if (angle < polar.front() - kRounding_rad || angle > polar.back() + kRounding_rad) return 0;
  const Ascending::Cell p = polar_.cell(angle);
  const double* const column = values_.data() + p.index;
  if (symmetry_ == Symmetry::round) return column[0] + p.fraction * (column[1] - column[0]);
  const double azimuth = folded_azimuth_rad(d);
  if (symmetry_ == Symmetry::part &&
      (azimuth < azimuth_.knots().front() - kRounding_rad || azimuth > azimuth_.knots().back() + kRounding_rad)) {
    return 0;
  }
  const Ascending::Cell a = azimuth_.cell(azimuth);
  const double* const here = column + a.index * polar.size();
  const double* const next = here + polar.size();
  const double lower = here[0] + p.fraction * (here[1] - here[0]);
  const double upper = next[0] + p.fraction * (next[1] - next[0]);
  return lower + a.fraction * (upper - lower);
}

/// Solves  ∫₀ˣ (value + slope t) sin(start + t) dt = share · integral  by Newton's method.
SphereTable::Polar SphereTable::draw_polar(const Piece& piece, double share) {
  const double sin0 = piece.sin_start;
  const double cos0 = piece.cos_start;
  const double target = share * piece.integral;
  const auto step = [&](double x, double& excess) {
    const Small small(x);
    excess = piece.value * (sin0 * small.sine + cos0 * small.versine) +
             piece.slope * (sin0 * (x * small.sine - small.versine) + cos0 * (small.sine_excess + x * small.versine)) -
             target;
    return excess / ((piece.value + piece.slope * x) * (sin0 + cos0 * small.sine - sin0 * small.versine));
  };
  double x = piece.width_rad * linear_place(piece.density_start, piece.density_end, share);
  double excess = 0;
  if (piece.gentle) {  // the first guess is good to 1e-3 of the width, and each step squares that error
    x -= step(x, excess);
    x -= step(x, excess);
    x = std::clamp(x, 0.0, piece.width_rad);
  } else {
    double low = 0;
    double high = piece.width_rad;
    for (int round = 0; round < 60; ++round) {
      double next = x - step(x, excess);
      (excess > 0 ? high : low) = x;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      const double moved = std::abs(next - x);
      x = next;
      if (moved <= 1e-5 * x) break;
    }
  }
  const Small small(x);
  return {piece.start_rad + x, sin0 + cos0 * small.sine - sin0 * small.versine,
          cos0 - sin0 * small.sine - cos0 * small.versine};
}

SphereTable::Sample SphereTable::sample(double u, double v) const {
  const std::size_t at = cumulative_.interval(v);
  const double before = cumulative_.knots()[at];
  const double share = (v - before) / (cumulative_.knots()[at + 1] - before);
  const Piece& piece = pieces_[at];
  const Polar polar = draw_polar(piece, std::clamp(share, kMinShare, 1 - kMinShare));
  const auto& knots = polar_.knots();
  // Kept off the ends, where a row may be dark.
  const double t = std::clamp((polar.angle_rad - knots[piece.band]) / (knots[piece.band + 1] - knots[piece.band]),
                              kMinShare, 1 - kMinShare);

  if (symmetry_ == Symmetry::round) {
    const Turn turn(u);
    const double value = values_[piece.band] + t * (values_[piece.band + 1] - values_[piece.band]);
    return {{polar.sine * turn.cosine, polar.sine * turn.sine, polar.cosine}, value};
  }

  // Selects the mirror image. Every other one runs backwards, so that the azimuth has no jumps.
  const int images = copies(symmetry_);
  const double turned = u * images;
  const int image = std::clamp(static_cast<int>(turned), 0, images - 1);
  double along = std::clamp(turned - image, kMinShare, 1 - kMinShare);
  along = image % 2 == 1 ? 1 - along : along;

  const auto& azimuth = azimuth_.knots();
  const double* const lower = rings_.data() + piece.band * azimuth.size();
  const double* const upper = lower + azimuth.size();
  // Never decreases along a row, however different the two rows are; a difference of the two would, through rounding.
  const auto reached = [&](std::size_t a) { return (1 - t) * lower[a] + t * upper[a]; };
  const double target = along * reached(azimuth.size() - 1);
  // Cell with reached(low) ≤ target < reached(low + 1), by quarters and without branches, which would be mispredicted.
  std::size_t low = 0;
  for (std::size_t left = azimuth.size() - 1; left > 1;) {
    const std::size_t quarter = std::max<std::size_t>(1, left / 4);
    const std::size_t most = left - 1;
    low += quarter * (static_cast<std::size_t>(reached(low + quarter) <= target) +
                      static_cast<std::size_t>(2 * quarter <= most && reached(low + 2 * quarter) <= target) +
                      static_cast<std::size_t>(3 * quarter <= most && reached(low + 3 * quarter) <= target));
    left -= std::min(most, 3 * quarter);
  }
  const std::size_t high = low + 1;
  const double start = reached(low);
  const double of_cell = std::clamp((target - start) / (reached(high) - start), kMinShare, 1 - kMinShare);
  const auto blend = [&](std::size_t a) {
    return value(a, piece.band) + t * (value(a, piece.band + 1) - value(a, piece.band));
  };
  const double from = blend(low);
  const double to = blend(high);
  const double place = linear_place(from, to, of_cell);
  const double angle = azimuth[low] + place * (azimuth[high] - azimuth[low]);
  const Turn turn(angle * (0.5 / kPi));
  // Signs of x and y by symmetry and image: a table, since random images would be mispredicted.
  constexpr double kSigns[6][4][2] = {{{1, 1}, {1, 1}, {1, 1}, {1, 1}},  {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}},
                                      {{1, 1}, {1, -1}, {1, 1}, {1, 1}}, {{1, 1}, {-1, 1}, {1, 1}, {1, 1}},
                                      {{1, 1}, {1, 1}, {1, 1}, {1, 1}},  {{1, 1}, {1, 1}, {1, 1}, {1, 1}}};
  const auto& sign = kSigns[static_cast<std::size_t>(symmetry_)][image];
  const double x = polar.sine * turn.cosine * sign[0];
  const double y = polar.sine * turn.sine * sign[1];
  return {{x, y, polar.cosine}, from + place * (to - from)};
}

}  // namespace luxrig
