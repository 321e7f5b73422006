#pragma once
/// Reflected illuminance at places of the surfaces that receivers see: what points learn from each other.
///
/// Paths from neighbouring places see the same rest of the room. A record holds the reflected illuminance of one place
/// (a path's second vertex), estimated once by a few paths; a path that arrives nearby takes
/// the record's value instead of going on (irradiance as G. Ward et al. 1988 cache it, with the first reflection from
/// lamps left to the exact connections). What a path takes is the mean of the record and of those beside it, so that it
/// has less of one record's noise. Each replicate has records of its own, at places of its own, so that the error
/// of looking a little beside the place averages out over them, and shows, as their noise does.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

class TailRecords {
 public:
  struct Place {
    Vec3 position_world_m;
    Vec3 normal_world;
    double clear_m;  ///< up to this distance nothing stands between the record and its neighbours on the surface
  };

  /// Adds records of value 0; what is there keeps its index and value. Nobody has been told anything then.
  /// columns: emitters × channels, the same each time
  void append(std::span<const Place> places, std::size_t columns);

  struct Found {
    std::uint32_t record;
    double distance_m;
  };
  /// The nearest record on a surface that lies alike: normals within 25°, within about half a spacing of its plane.
  [[nodiscard]] std::optional<Found> nearest(const Vec3& position_world_m, const Vec3& normal_world) const;

  /// The records that share the cell of a grid with this one, as wide as one and a half times their spacing, and its
  /// plane. Is mutual.
  void find_beside(std::uint32_t record, std::vector<std::uint32_t>& beside) const;

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] const Place& place(std::size_t record) const { return places_[record]; }

  void set_clear_m(std::size_t record, double clear_m) { places_[record].clear_m = clear_m; }

  /// Reflected lux at level 1, channels × emitters: all emitters of a channel together. Of the record's own paths.
  [[nodiscard]] std::span<float> values(std::size_t record) { return {values_.data() + record * columns_, columns_}; }
  [[nodiscard]] std::span<const float> values(std::size_t record) const {
    return {values_.data() + record * columns_, columns_};
  }
  /// What it tells to those who ask: likewise, with the records beside it (SharedTails::blend).
  [[nodiscard]] std::span<float> told(std::size_t record) { return {told_.data() + record * columns_, columns_}; }
  [[nodiscard]] std::span<const float> told(std::size_t record) const {
    return {told_.data() + record * columns_, columns_};
  }
  /// Of what it tells: the lux of each channel at the emitters' levels, and which emitters give any.
  void sum_up(std::size_t record, std::span<const double> levels);
  [[nodiscard]] const Vec3& told_lux_rgb(std::size_t record) const { return sums_[record].lux_rgb; }
  /// Calls back with [begin, end) of emitters outside of which none gives it light.
  template <class Call>
  void each_lit(std::size_t record, Call call) const {
    for (std::uint32_t i = sums_[record].begin; i < sums_[record].end; ++i) call(lit_[i].begin, lit_[i].end);
  }

 private:
  using Cell = std::array<std::int32_t, 3>;
  [[nodiscard]] Cell cell_of(const Vec3f& position_m) const;
  [[nodiscard]] std::size_t bucket_of(const Cell& cell) const;
  void build_grid();

  std::vector<Place> places_;
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
  /// What a search looks at, packed by bucket of a grid.
  struct Packed {
    Vec3f position_m;  ///< from the grid's origin
    Vec3f normal;
    std::uint32_t record;
  };
  std::vector<std::uint32_t> bucket_begin_;
  std::vector<Packed> packed_;
};

}  // namespace luxrig
