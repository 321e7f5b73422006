#pragma once
/// Which of the potential lights to take: the one with most votes, then the next among what it left (thesis §6.5.4).

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/highlight/lights/potential_lights.h"

namespace luxrig {

/// Lights taken so far, and what the others still count. A light serves the features that it has votes of (a share of
/// their points, if asked for); votes of served features count for no light. Adding or removing one costs the entries
/// of the features that become served, or are no longer, and a look at each light's count: nothing is voted again.
/// Counts are whole numbers (weights in parts of 2^-61 of their sum, so one is off by less than 1e-18 of that), so that
/// they depend on which lights are taken alone, not on the way there.
class LightSelection {
 public:
  /// serving_share   a light serves a feature of which at least this share of points voted for it; 0: any vote, as in
  ///                 the thesis. 0…1 (asserted)
  explicit LightSelection(PotentialLights lights, double serving_share = 0);

  /// Takes the light that counts most (ties: the lowest index). Nothing when none counts anything: every feature that
  /// can be served is.
  std::optional<std::uint32_t> add();
  void add(std::uint32_t light);  ///< this one; must not be taken yet (asserted)
  void remove(std::size_t i);     ///< the i-th taken; those after it move up

  [[nodiscard]] const PotentialLights& all() const { return lights_; }
  [[nodiscard]] std::span<const std::uint32_t> taken() const { return taken_; }
  [[nodiscard]] double count(std::uint32_t light) const;  ///< [1/m²], of features not served yet
  [[nodiscard]] bool is_served(std::uint32_t feature) const { return served_by_[feature] > 0; }
  /// Share of all features, or of their points, that are served.
  [[nodiscard]] double coverage() const;
  [[nodiscard]] double point_coverage() const;
  [[nodiscard]] std::uint64_t entries_changed() const { return entries_changed_; }  ///< by all steps so far

 private:
  struct Entry {
    std::uint32_t other;  // light or feature
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
  int most = 8;                    ///< by wish
  std::optional<double> coverage;  ///< stop when so large a share of the features is served
  /// Local contrast of lights (indices of all().lights): stop when it rises no more, and leave out what did not make
  /// it rise. Empty: not asked.
  std::function<double(std::span<const std::uint32_t>)> local_contrast;
  int patience = 1;  ///< so many lights in a row may fail to raise it
};

/// Adds lights to what is taken until one of these is reached, or none counts anything. Returns the contrast after each
/// light asked about, those that were left out again, too. Refuses fewer than one light, a coverage outside 0…1, a
/// patience below 1.
[[nodiscard]] Result<std::vector<double>> select_lights(LightSelection& selection, const LightNumber& number);

}  // namespace luxrig
