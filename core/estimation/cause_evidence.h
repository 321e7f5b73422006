#pragma once
/// Evidence of each possible cause of a LightChange. Private to change_cause.cpp.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/estimation/change_cause.h"

namespace luxrig {

struct CauseEvidence {
  ChangeCause cause;
  double badness = 0;      ///< -2 log of its evidence, up to what all causes share
  double chi_squared = 0;  ///< per meter that is read, at its best
};

class CauseJudge {
 public:
  explicit CauseJudge(const LightChange& change);

  [[nodiscard]] std::size_t read() const { return read_.size(); }
  [[nodiscard]] std::size_t data() const { return read_.size() * (1 + change_.dips.size()); }
  /// χ² of the change if nothing is wrong; of_nothing() with what the dips tell of that.
  [[nodiscard]] double of_change_of_nothing() const;
  [[nodiscard]] double of_nothing() const;
  /// All causes but those that are surely farther than kFarBehind from the best: a rig of 400 lamps has 80,000 pairs.
  [[nodiscard]] std::vector<CauseEvidence> all() const;
  static constexpr double kFarBehind = 40;
  /// How far a dip of this lamp would set these causes apart, in χ².
  [[nodiscard]] double apart_by_dip(const ChangeCause& a, const ChangeCause& b, std::size_t lamp, double level_share,
                                    const Eigen::VectorXd& dip_error_lx) const;

 private:
  using Kind = ChangeCause::Kind;
  /// -2 log of a probability density, and χ² where it is largest.
  struct Fit {
    double badness = 0, chi_squared = 0;
  };
  /// A reading is offset + slope · (light of one lamp, light of another) + noise.
  struct Datum {
    double value = 0, error = 1, offset = 0;
    std::array<double, 2> slope{};
  };
  /// What a dip changes at a meter, over what is dimmed: a share of the light that `lamp` gave at `at`, and more.
  struct Follows {
    Eigen::Index at = 0, lamp = 0;
    double share = 1, plus_lx = 0;
  };
  /// What dips of this fixture change at this meter if a cause holds.
  using Following = std::function<Follows(std::size_t dipped, Eigen::Index meter)>;

  [[nodiscard]] double light_error(Eigen::Index meter, Eigen::Index lamp) const;
  [[nodiscard]] double curve_error(Eigen::Index lamp) const;
  [[nodiscard]] Fit fit(std::span<const Datum> data, Eigen::Index at, Eigen::Index lamp, Eigen::Index other) const;
  /// Of the dips, as far as they are not of `without`.
  [[nodiscard]] Fit of_dips(const Following& following, std::ptrdiff_t without = -1) const;
  [[nodiscard]] Fit of_dips_of(std::size_t fixture, const Following& following) const;
  /// No share of its light between these that a lamp gives explains the change better than this, in χ².
  struct Gives {
    Eigen::Index lamp = 0;
    double least = 0, most = 1;
  };
  [[nodiscard]] double least_misfit(std::span<const Gives> lamps) const;
  /// Whether a cause with at least this badness need not be looked at.
  [[nodiscard]] static bool far_behind(const std::vector<CauseEvidence>& found, double least_badness);
  [[nodiscard]] double of_no_change(Eigen::Index meter, double uncertain_lx = 0) const;
  [[nodiscard]] double free_reading(Eigen::Index meter, double range_lx) const;
  void add(std::vector<CauseEvidence>& found, Kind kind, std::vector<std::size_t> who, double share, const Fit& fit,
           double alike) const;

  void all_light(std::vector<CauseEvidence>& found) const;
  void daylight(std::vector<CauseEvidence>& found) const;
  void lamp(std::vector<CauseEvidence>& found, std::size_t f) const;
  void moved(std::vector<CauseEvidence>& found, std::size_t f) const;
  void meter(std::vector<CauseEvidence>& found, Eigen::Index m) const;
  void meters_swapped(std::vector<CauseEvidence>& found, Eigen::Index a, Eigen::Index b) const;
  void lamps_swapped(std::vector<CauseEvidence>& found, std::size_t f, std::size_t g) const;
  [[nodiscard]] Fit lamp_at(std::size_t f, double share) const;
  [[nodiscard]] Fit lamps_swapped_at(std::size_t f, std::size_t g, double of_f, double of_g, double exponent_f,
                                     double exponent_g) const;
  [[nodiscard]] Follows follows(const ChangeCause& cause, std::size_t dipped, Eigen::Index meter) const;

  const LightChange& change_;
  std::vector<Eigen::Index> read_;
  std::vector<std::size_t> dipped_;  ///< fixtures, each once
  Eigen::VectorXd off_;
  Fit usual_dips_;
};

}  // namespace luxrig
