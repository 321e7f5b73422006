#pragma once
/// Incoming radiance of cells as spherical harmonics: in one channel (all surfaces grey), RGB, or YCoCg with less
/// detail in the chrominance (thesis §3.2.2; K. Vardis et al. 2014).

#include "tools/bench/cache/cache_settings.h"
#include "tools/bench/cache/spherical_harmonics.h"

namespace luxrig {

class FieldLayout {
 public:
  FieldLayout(const CacheSettings& settings, bool grey)
      : channels_(grey ? 1 : 3),
        ycocg_(!grey && settings.ycocg),
        first_(coefficients_of_order(settings.luminance_order)),
        others_(grey ? 0 : coefficients_of_order(ycocg_ ? settings.chrominance_order : settings.luminance_order)) {}

  [[nodiscard]] int channels() const { return channels_; }
  /// Numbers per cell.
  [[nodiscard]] int size() const { return first_ + (channels_ - 1) * others_; }

  /// Adds radiance [cd/m² · sr, per primary] from a direction with harmonics `y` to a cell's numbers.
  template <class Row>
  void add(const Harmonics& y, const Vec3& rgb, Row&& cell) const {
    const Vec3 colour = ycocg_ ? ycocg_of(rgb) : rgb;
    cell.head(first_) += (colour[0] * y.head(first_)).template cast<float>().transpose();
    for (int c = 1; c < channels_; ++c)
      cell.segment(first_ + (c - 1) * others_, others_) +=
          (colour[c] * y.head(others_)).template cast<float>().transpose();
  }

  /// Illuminance per primary of a plane with this cosine lobe.
  template <class Row>
  [[nodiscard]] Vec3 illuminance(const Row& cell, const Harmonics& lobe) const {
    Vec3 colour = Vec3::Zero();
    colour[0] = cell.head(first_).template cast<double>().transpose().dot(lobe.head(first_));
    for (int c = 1; c < channels_; ++c)
      colour[c] =
          cell.segment(first_ + (c - 1) * others_, others_).template cast<double>().transpose().dot(lobe.head(others_));
    return ycocg_ ? rgb_of(colour) : colour;
  }

  [[nodiscard]] static Vec3 ycocg_of(const Vec3& rgb) {
    return {rgb[0] / 4 + rgb[1] / 2 + rgb[2] / 4, (rgb[0] - rgb[2]) / 2, -rgb[0] / 4 + rgb[1] / 2 - rgb[2] / 4};
  }
  [[nodiscard]] static Vec3 rgb_of(const Vec3& y) { return {y[0] + y[1] - y[2], y[0] + y[2], y[0] - y[1] - y[2]}; }

 private:
  int channels_;
  bool ycocg_;
  int first_, others_;  ///< coefficients of the first channel, and of each other one
};

}  // namespace luxrig
