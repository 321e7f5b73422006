#pragma once
/// Reflected illuminance at places of the surfaces that receivers see, shared between paths.
///
/// Paths from neighbouring places see the same rest of the room. A record holds the reflected illuminance of one place
/// (a path's second vertex), estimated once by a few paths. A path that arrives nearby takes the record's value instead
/// of continuing (irradiance caching, G. Ward et al. 1988, with the first reflection from lamps left to the exact
/// connections). The value is the mean of the record and its neighbours, which reduces the noise of single records.
/// Each replicate has its own records at its own places, so the error from the distance averages out over replicates
/// and shows in their spread, as does noise.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

class IrradianceRecords {
 public:
  struct Vertex {
    Vec3 position_world_m;
    Vec3 normal_world;
    double clear_m;  ///< up to this distance nothing is between the record and its neighbours on the surface
  };

  /// Adds records of value 0; existing ones keep index and value. told() of all records is then 0.
  /// columns: emitters × channels, the same each time
  void append(std::span<const Vertex> places, std::size_t columns);

  struct Found {
    std::uint32_t record;
    double distance_m;
  };
  /// The nearest record on a similar surface: normals within 25°, within about half a spacing of its plane.
  [[nodiscard]] std::optional<Found> nearest(const Vec3& position_world_m, const Vec3& normal_world) const;

  /// Records in the same cell of a grid (one and a half times their spacing wide) and in the same plane. Symmetric.
  void find_beside(std::uint32_t record, std::vector<std::uint32_t>& beside) const;

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] const Vertex& place(std::size_t record) const { return places_[record]; }

  void set_clear_m(std::size_t record, double clear_m) { places_[record].clear_m = clear_m; }

  /// Reflected lux at level 1 from the record's own paths, channels × emitters, channel by channel.
  [[nodiscard]] std::span<float> values(std::size_t record) { return {values_.data() + record * columns_, columns_}; }
  [[nodiscard]] std::span<const float> values(std::size_t record) const {
    return {values_.data() + record * columns_, columns_};
  }
  /// The value that paths take: the same, averaged with the neighbours (IrradianceCache::blend).
  [[nodiscard]] std::span<float> told(std::size_t record) { return {told_.data() + record * columns_, columns_}; }
  [[nodiscard]] std::span<const float> told(std::size_t record) const {
    return {told_.data() + record * columns_, columns_};
  }
  /// Computes for told(): the lux of each channel at the emitters' levels, and which emitters contribute.
  void sum_up(std::size_t record, std::span<const double> levels);
  [[nodiscard]] const Vec3& told_lux_rgb(std::size_t record) const { return sums_[record].lux_rgb; }
  /// Calls with ranges [begin, end) of emitters; no emitter outside them gives it light.
  template <class Call>
  void each_lit(std::size_t record, Call call) const {
    for (std::uint32_t i = sums_[record].begin; i < sums_[record].end; ++i) call(lit_[i].begin, lit_[i].end);
  }

 private:
  using Cell = std::array<std::int32_t, 3>;
  [[nodiscard]] Cell cell_of(const Vec3f& position_m) const;
  [[nodiscard]] std::size_t bucket_of(const Cell& cell) const;
  void build_grid();

  std::vector<Vertex> places_;
  std::size_t columns_ = 0;
  std::vector<float> values_, told_;
  struct Sums {
    Vec3 lux_rgb = Vec3::Zero();
    std::uint32_t begin = 0, end = 0;  ///< of lit_
  };
  struct Lit {
    std::uint32_t begin, end;  ///< of emitters
  };
  std::vector<Sums> sums_;
  std::vector<Lit> lit_;
  Vec3 origin_world_m_ = Vec3::Zero();
  float cell_m_ = 1;
  std::uint32_t row_cells_ = 1, layer_cells_ = 1;
  /// Data for a search, packed by grid bucket.
  struct Packed {
    Vec3f position_m;  ///< from the grid's origin
    Vec3f normal;
    std::uint32_t record;
  };
  std::vector<std::uint32_t> bucket_begin_;
  std::vector<Packed> packed_;
};

}  // namespace luxrig
