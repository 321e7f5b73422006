#pragma once
/// Chooses from the potential lights: the one with most votes, then the best of what it left (thesis §6.5.4).

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/highlight/lights/potential_lights.h"

namespace luxrig {

/// Lights chosen so far, and the remaining votes of the others. A light serves the features that it has votes of
/// (optionally, only those with a minimum share of their points); votes of served features no longer count. Adding or
/// removing a light costs the entries of the features that change state, and one look at each light's count; votes are
/// never cast again. Counts are integers (weights in units of 2^-61 of their sum, so each is within 1e-18 of it), so
/// they depend only on the chosen lights, not on the order.
class LightSelection {
 public:
  /// serving_share   a light serves a feature if at least this share of its points voted for it; 0 = any vote, as in
  ///                 the thesis. 0…1 (asserted)
  explicit LightSelection(PotentialLights lights, double serving_share = 0);

  /// Chooses the light with the largest count (ties: the lowest index). Empty when all counts are 0: every feature that
  /// can be served is served.
  std::optional<std::uint32_t> add();
  void add(std::uint32_t light);  ///< must not be chosen yet (asserted)
  void remove(std::size_t i);     ///< the i-th chosen; later ones move up

  [[nodiscard]] const PotentialLights& all() const { return lights_; }
  [[nodiscard]] std::span<const std::uint32_t> taken() const { return taken_; }
  [[nodiscard]] double count(std::uint32_t light) const;  ///< [1/m²], of unserved features
  [[nodiscard]] bool is_served(std::uint32_t feature) const { return served_by_[feature] > 0; }
  /// Served share of all features, or of their points.
  [[nodiscard]] double coverage() const;
  [[nodiscard]] double point_coverage() const;
  [[nodiscard]] std::uint64_t entries_changed() const { return entries_changed_; }  ///< in all steps so far

 private:
  struct Entry {
    std::uint32_t other;  // index of the light or feature
    std::int64_t weight;
  };
  void change(std::uint32_t light, bool taken);
  [[nodiscard]] bool serves(const LightVote& vote) const;

  PotentialLights lights_;
  double serving_share_;
  double unit_;                               // 1/m² per part
  std::vector<std::uint64_t> feature_begin_;  // entries_ by feature
  std::vector<Entry> entries_;
  std::vector<std::int64_t> counts_;  // per light
  std::vector<std::uint32_t> served_by_;
  std::vector<std::uint8_t> is_taken_;
  std::vector<std::uint32_t> taken_;
  std::uint64_t entries_changed_ = 0;
};

struct LightNumber {
  int most = 8;                    ///< upper limit
  std::optional<double> coverage;  ///< stop when this share of the features is served
  /// Local contrast of lights (indices of all().lights): stop when it no longer rises, and drop the lights that did not
  /// raise it. Empty = not used.
  std::function<double(std::span<const std::uint32_t>)> local_contrast;
  int patience = 1;  ///< this many lights in a row may fail to raise it
};

/// Adds lights to the selection until one of these limits is reached or all counts are 0. Returns the contrast after
/// each light that was evaluated, including dropped ones. Refuses fewer than one light, a coverage outside 0…1, a
/// patience below 1.
[[nodiscard]] Result<std::vector<double>> select_lights(LightSelection& selection, const LightNumber& number);

}  // namespace luxrig
