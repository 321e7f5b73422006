#pragma once
/// What is not known of a rig's light, as one Gaussian: the output of each lamp, how its mount is off, the room's paint,
/// the gain of each luxmeter, how a camera shows light, and a rest of each lamp's light at each place that none of these
/// explains. Readings under known levels narrow it; light at any receiver follows from it, with its standard error.
///
///   reading = e^γ(meter) · (Σ_j level_j (e^g(j) (L_j + Σ_k D_jk θ_jk + Σ_p P_pj ρ_p) + L_j δ_j(place))) + fixed
///
/// L, D, P: LightSensitivity. The light changes in proportion to mount and paint only near where they were taken, so
/// whoever has found a mount to be far off takes them anew there (relinearise). A camera (Showing) multiplies each lamp's
/// light by its response to that kind of lamp, and all by what its lens loses there and by the true reflectance of the
/// paint that it sees, and adds stray light.
///
/// The estimate is the maximum a posteriori, by Gauss-Newton in the space of the unknowns, the rest taken out of it: that
/// is like noise which readings at one place share. Readings that no values explain weigh less (Student's t).
///
/// Source: A. Tarantola, Inverse Problem Theory (2005), ch. 3; C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for
/// Machine Learning (2006), 2.7, for a linear model with a rest.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/calibration/reading_noise.h"

namespace luxrig {

/// Unknowns of a mount: position along world x, y, z [m], then turns about world x, y, z [rad].
inline constexpr Eigen::Index kMountUnknowns = 6;

/// The light of a rig at level 1 and its change with what is not known. Receivers: the rig's points, then its luxmeters.
struct LightSensitivity {
  Eigen::MatrixXd lux;                 ///< L: receivers × fixtures
  std::vector<Eigen::MatrixXd> mount;  ///< D: per fixture, receivers × kMountUnknowns [lx/m, lx/rad]
  /// H: per fixture, receivers × kMountUnknowns²: second derivatives, row by row of each matrix; empty = 0. A beam's middle
  /// has no slope, and still loses light when its lamp is off.
  std::vector<Eigen::MatrixXd> bend{};
  /// P: per material, receivers × fixtures: change of lux with a relative change of its reflectance of 1.
  std::vector<Eigen::MatrixXd> paint{};
  Eigen::VectorXd paint_taken_at{};  ///< per material: true over stated reflectance less 1, of lux; empty = 0
  /// Receivers × fixtures: LightPriors::rest_share of this light is what nothing explains; empty = lux.
  Eigen::MatrixXd doubtful{};
  /// Per receiver: receivers with the same number are at the same place, such as a luxmeter at a point. Empty = each its
  /// own.
  std::vector<std::size_t> place{};
};

/// Standard deviations before anything is measured.
struct LightPriors {
  double log_output = 0.15;     ///< of a lamp over its rated flux
  double dimmer_exponent = 0;   ///< of a dimmer whose curve is not measured
  Eigen::VectorXd read_at{};    ///< per fixture: the level at which it is read, > 0; empty = 1
  double position_m = 0.05;     ///< per axis
  double angle_rad = 0.03;      ///< per axis
  double reflectance = 0.1;     ///< relative
  double rest_share = 0.02;     ///< of a lamp's light at a place
  Eigen::VectorXd log_meter{};  ///< per instrument: the rig's luxmeters, those in a hand, then what a camera has
  Eigen::VectorXd stray{};      ///< shares of stray light, such as a lens's flare
};

/// How a camera shows light beside the factor of its meter. Instruments: of LightPriors::log_meter.
struct Showing {
  struct Part {
    std::size_t of = 0;
    double weight = 0;
  };
  std::vector<Part> factors{};         ///< instruments whose logarithms count too, each times its weight
  std::vector<std::size_t> of_lamp{};  ///< per fixture: the instrument whose factor its light has; empty = none
  std::optional<std::size_t> paint{};  ///< the material seen: true over stated reflectance is a factor
  std::vector<Part> stray{};           ///< of LightPriors::stray: that share of these lux is added
};

/// Light at a receiver under some levels; as this instrument shows it, if there is one.
struct LightQuery {
  std::size_t receiver = 0;
  Eigen::VectorXd level;  ///< per fixture: its light over that at level 1, as known
  std::optional<std::size_t> meter{};
  Showing showing{};
};

struct LightReading {
  std::size_t receiver = 0, meter = 0;  ///< meter: of LightPriors::log_meter
  double lux = 0;
  double standard_error_lx = 0;  ///< of its noise, > 0
  Eigen::VectorXd level;         ///< as in LightQuery
  double fixed_lx = 0;           ///< light of no fixture in it, as the meter shows it
  Showing showing{};
};

struct LightEstimate {
  double lux = 0, standard_error_lx = 0;
  [[nodiscard]] double share_of_error() const { return lux > 0 ? standard_error_lx / lux : 0; }
};

/// What the variance of an estimate is made of [lx²]: its parts sum to it.
struct LightBudget {
  double output = 0, mount = 0, paint = 0;  ///< of all lamps, all mounts, all materials
  Eigen::VectorXd instrument;               ///< per entry of LightPriors::log_meter
  Eigen::VectorXd stray;                    ///< per entry of LightPriors::stray
  double rest = 0, noise = 0;               ///< of light that nothing explains, and of the readings
  [[nodiscard]] double sum() const { return output + mount + paint + instrument.sum() + stray.sum() + rest + noise; }
};

class LightUnknowns {
 public:
  /// Sizes of both must agree (asserted).
  LightUnknowns(LightSensitivity sensitivity, LightPriors priors);

  /// LightPriors::read_at, as it turned out: a dimmer whose curve is measured is known up to where it was read. Before
  /// the first reading is learnt (asserted).
  void read_at(const Eigen::VectorXd& level);
  /// Adds readings and estimates anew from all of them.
  void learn(std::span<const LightReading> readings);
  /// Light and its change at the mounts found so far (mount()), in place of those at the mounts of the file.
  void relinearise(LightSensitivity sensitivity);

  /// Light at a receiver. level: per fixture.
  [[nodiscard]] LightEstimate at(std::size_t receiver, const Eigen::VectorXd& level) const;
  /// Covariance of what is asked for, by the linear model [lx²].
  [[nodiscard]] Eigen::MatrixXd covariance(std::span<const LightQuery> queries) const;

  /// Why the light there is not better known: the standard error is of the linear model, as in covariance().
  [[nodiscard]] LightBudget budget(std::size_t receiver, const Eigen::VectorXd& level) const;

  /// Output over rated flux.
  [[nodiscard]] double gain(std::size_t fixture) const;
  [[nodiscard]] double gain_standard_error(std::size_t fixture) const;
  /// The level at which it is read. Its output is that of its light there, by the curve that is known of its dimmer: below
  /// level 1 it is not its output at full light.
  [[nodiscard]] double read_at(std::size_t fixture) const;
  /// Readings have told something of it; else gain() is the rig file's.
  [[nodiscard]] bool gain_is_measured(std::size_t fixture) const;
  /// How far the mount is off: kMountUnknowns entries.
  [[nodiscard]] Eigen::VectorXd mount(std::size_t fixture) const;
  [[nodiscard]] Eigen::VectorXd mount_standard_error(std::size_t fixture) const;
  /// True over stated reflectance.
  [[nodiscard]] double paint(std::size_t material) const;
  [[nodiscard]] double paint_standard_error(std::size_t material) const;
  /// Reading over light.
  [[nodiscard]] double meter_gain(std::size_t meter) const;
  [[nodiscard]] double meter_gain_standard_error(std::size_t meter) const;
  /// Share of stray light, of LightPriors::stray.
  [[nodiscard]] double stray(std::size_t entry) const;
  [[nodiscard]] double stray_standard_error(std::size_t entry) const;
  /// All that were learnt, in order.
  [[nodiscard]] const std::vector<LightReading>& readings() const { return readings_; }
  /// Of the last estimate, per reading: by how many standard errors it is off what all together say.
  [[nodiscard]] const std::vector<double>& surprise() const { return surprise_; }

 private:
  [[nodiscard]] Eigen::Index fixtures() const { return light_.lux.cols(); }
  [[nodiscard]] Eigen::Index meters() const { return priors_.log_meter.size(); }
  [[nodiscard]] Eigen::Index materials() const { return static_cast<Eigen::Index>(light_.paint.size()); }
  [[nodiscard]] Eigen::Index mount_at(Eigen::Index fixture) const { return fixtures() + kMountUnknowns * fixture; }
  [[nodiscard]] Eigen::Index paint_at(Eigen::Index material) const { return mount_at(fixtures()) + material; }
  [[nodiscard]] Eigen::Index meter_at(Eigen::Index meter) const { return paint_at(materials()) + meter; }
  [[nodiscard]] Eigen::Index stray_at(Eigen::Index entry) const { return meter_at(meters()) + entry; }
  [[nodiscard]] Eigen::Index unknowns() const { return stray_at(priors_.stray.size()); }

  void check(const LightSensitivity& sensitivity) const;
  void take_output_priors();
  void check(const Showing& showing) const;
  [[nodiscard]] std::size_t place_of(std::size_t receiver) const;
  /// What is asked for without the rest, and its derivative by all unknowns.
  [[nodiscard]] double light_and_slope(const LightQuery& query, double fixed_lx, Eigen::VectorXd& slope) const;
  /// What a camera multiplies all light by, and one lamp's alone.
  [[nodiscard]] double shown_share(const Showing& showing) const;
  [[nodiscard]] double lamp_share(const Showing& showing, Eigen::Index fixture) const;
  /// Covariance of two queries' rests, before anything is measured.
  [[nodiscard]] double rest_covariance(const LightQuery& a, const LightQuery& b) const;
  /// Of a query's rest with those of the readings.
  [[nodiscard]] Eigen::VectorXd rest_with_readings(const LightQuery& query) const;
  void estimate();
  [[nodiscard]] double variance_of(Eigen::Index unknown) const;
  /// Mean and variance that the bend of the light adds at a receiver.
  [[nodiscard]] std::pair<double, double> of_bend(Eigen::Index receiver, const Eigen::VectorXd& level) const;

  LightSensitivity light_;
  LightPriors priors_;
  Eigen::VectorXd prior_variance_;
  Eigen::VectorXd value_;     ///< of the unknowns
  Eigen::VectorXd taken_at_;  ///< of mounts: where the sensitivity was taken
  std::vector<LightReading> readings_;
  std::vector<LightQuery> asked_;            ///< of the readings
  Eigen::MatrixXd slopes_;                   ///< readings × unknowns
  ReadingNoise noise_;                       ///< of the readings, as they were weighed
  Eigen::MatrixXd posterior_;                ///< covariance of the unknowns
  Eigen::VectorXd left_;                     ///< of the readings: noise⁻¹ · what the unknowns leave of them
  std::vector<double> surprise_;
};

}  // namespace luxrig
