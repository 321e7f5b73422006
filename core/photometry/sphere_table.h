#pragma once
/// A function of direction on a grid of angles, bilinear between them, for luminaires and skies. Looks up, integrates
/// and samples exactly; samples have the table's own density.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Ascending numbers, with a guide table for finding the interval of a number.
class Ascending {
 public:
  Ascending() = default;
  explicit Ascending(std::vector<double> knots);  ///< two or more, ascending (equal neighbours allowed, not all)

  /// i such that knots[i] ≤ x < knots[i + 1], within rounding; the first or last interval for an x outside.
  [[nodiscard]] std::size_t interval(double x) const;

  struct Cell {
    std::size_t index;  ///< of the lower knot
    double fraction;    ///< 0…1 towards the upper
  };
  [[nodiscard]] Cell cell(double x) const;

  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }

 private:
  std::vector<double> knots_;
  std::vector<std::uint32_t> guide_;  // per bucket of equal width: the interval that contains its start
  double buckets_per_unit_ = 0;
  bool one_each_ = false;    // no bucket holds two knots
  double inverse_step_ = 0;  // 0 = unevenly spaced
};

/// Frame: polar angle from +Z, azimuth from +X towards +Y.
class SphereTable {
 public:
  /// Meaning of the stored azimuths.
  enum class Symmetry {
    round,        ///< one column for all azimuths (azimuth_rad is ignored)
    quadrant,     ///< 0…90°, mirrored into the other three
    half_0_180,   ///< 0…180°, mirrored about the plane 0–180
    half_90_270,  ///< 90…270°, mirrored about the plane 90–270
    none,         ///< 0…360°, both ends given
    part          ///< from… to, within -180…180°; 0 elsewhere
  };

  /// polar_rad, azimuth_rad   ascending; polar within 0…π, the value is 0 outside its range
  /// values                   [azimuth][polar], ≥ 0, the largest within 1e-60…1e60; below 1e-60 of it, taken as 0
  /// requires                 matching sizes, at least two polar angles (and azimuths, unless round), an integral > 0
  SphereTable(Symmetry symmetry, std::vector<double> polar_rad, std::vector<double> azimuth_rad,
              std::vector<double> values);

  /// Value in a unit direction: bilinear in the two angles.
  [[nodiscard]] double at(const Vec3& direction) const;

  /// Integral of the interpolant over the sphere, exact to rounding.
  [[nodiscard]] double integral() const { return integral_; }
  [[nodiscard]] double largest() const { return largest_; }

  struct Sample {
    Vec3 direction;  ///< unit
    double value;    ///< at(direction), > 0
  };
  /// Direction for a point of the unit square, sampled with density at(direction) / integral() per steradian: polar
  /// angle by v, azimuth by u. Continuous except for gaps where the table is 0.
  [[nodiscard]] Sample sample(double u, double v) const;

  [[nodiscard]] const std::vector<double>& polar_rad() const { return polar_.knots(); }
  [[nodiscard]] const std::vector<double>& azimuth_rad() const { return azimuth_.knots(); }
  [[nodiscard]] double value(std::size_t azimuth, std::size_t polar) const {
    return values_[azimuth * polar_.knots().size() + polar];
  }
  [[nodiscard]] Symmetry symmetry() const { return symmetry_; }

 private:
  /// An interval of polar angle, short enough to use series for sine and cosine.
  struct Piece {
    double start_rad, sin_start, cos_start;
    double value, slope;  // integral over azimuth at its start, and its increase per rad
    double width_rad;
    double integral;                    // over the interval, with sin of the polar angle
    double density_start, density_end;  // of the integral, per rad
    std::uint32_t band;
    bool gentle;  // the two are similar
  };
  struct Polar {
    double angle_rad, sine, cosine;
  };

  [[nodiscard]] double folded_azimuth_rad(const Vec3& direction) const;
  void add_pieces(std::size_t band, double ring_lower, double ring_upper);
  [[nodiscard]] static Polar draw_polar(const Piece& piece, double share);

  Symmetry symmetry_;
  Ascending polar_;
  Ascending azimuth_;
  std::vector<double> values_;
  std::vector<double> rings_;  // [polar][azimuth]: integral over azimuth from the first one
  std::vector<Piece> pieces_;
  Ascending cumulative_;  // of pieces_, 0…1
  double integral_ = 0;
  double largest_ = 0;
};

}  // namespace luxrig
