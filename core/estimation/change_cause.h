#pragma once
/// Why luxmeters read something else than before at the same levels: which single cause explains all of them, and
/// whether any other would, too.
///
/// Each cause predicts how the reading of every meter changes, and how the meters follow when a lamp is dimmed for a
/// moment. A lamp that loses light takes from each meter what it gave there, and a dead one changes nothing when it is
/// dimmed. A covered meter changes alone, and follows by what it still sees. A head that was knocked takes from some
/// meters and gives to others. A cause is found only if the changes are far beyond noise, it explains them, and no other
/// cause explains them nearly as well. Causes are compared by their evidence, as -2 times its logarithm: the probability
/// of what was read, over all that is not known (each lamp's light at each meter, its curve, the share that is left).
///
/// Source: D. J. C. MacKay, Bayesian Interpolation, Neural Computation 4 (1992): evidence and Occam factors.

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace luxrig {

/// A lamp that was dimmed for a moment to see which meters follow.
struct LampDip {
  std::size_t fixture = 0;
  double level_share = 1;     ///< of its level that was left, as sent
  Eigen::VectorXd change_lx;  ///< per luxmeter: reading less that beside the dip; NaN = not read
  Eigen::VectorXd error_lx;   ///< standard error by noise, > 0
};

/// At one set of levels. Vectors: an entry per luxmeter; NaN in now_lx = not read.
struct LightChange {
  Eigen::VectorXd before_lx, now_lx;
  Eigen::VectorXd error_lx;         ///< standard error of the difference by noise, > 0
  Eigen::MatrixXd of_fixture;       ///< luxmeters × fixtures: light of each in before_lx [lx]
  Eigen::VectorXd daylight;         ///< in before_lx; empty = none
  Eigen::VectorXd level;            ///< per fixture
  Eigen::MatrixXd fixture_error{};  ///< standard error of of_fixture [lx]; empty = kLampShare of each
  Eigen::VectorXd curve_error{};    ///< per fixture: of its light's exponent over its level, a share; empty = kCurve
  /// Level that the first fixture has with what is sent to the second; empty = the level of the second.
  std::function<double(std::size_t, std::size_t)> level_with_drive_of{};
  std::vector<LampDip> dips{};  ///< since the change
};

struct ChangeCause {
  enum class Kind {
    none,            ///< nothing beyond noise
    unclear,         ///< something, but no single cause explains it
    all_light,       ///< all light changes by the same share: supply voltage, warming up
    daylight,        ///< daylight changes
    lamp,            ///< who[0] gives other light than before
    meter,           ///< who[0] is covered, or shows something else than its light
    meters_swapped,  ///< who[0] and who[1]
    lamps_swapped,   ///< who[0] and who[1] get each other's level
    lamp_moved       ///< who[0] shines elsewhere
  };
  Kind kind = Kind::none;
  std::vector<std::size_t> who{};  ///< fixtures, or luxmeters if the kind is of meters
  double share = 1;  ///< light of the lamp, of all or of the day over that before; reading over before of a meter
};

/// The causes that explain the change about as well as the best, which comes first. Kind::unclear alone if none explains
/// it; empty if nothing changed. 1 ms for 12 lamps and 6 meters, a quarter of a second for 200 lamps and 20 meters: the
/// show searches beside its loop.
[[nodiscard]] std::vector<ChangeCause> likely_causes(const LightChange& change);
/// What a person is told of them: Kind::unclear alone if there are more than kMostCauses.
[[nodiscard]] std::vector<ChangeCause> causes_to_tell(std::vector<ChangeCause> likely);
/// Both.
[[nodiscard]] std::vector<ChangeCause> causes_of(const LightChange& change);

/// Which lamp to dim to this share of its level, so that the meters tell these causes apart; nullopt: none would.
/// may: per fixture, 1 = it may be dimmed. dip_error_lx: per luxmeter, as LampDip::error_lx will be.
[[nodiscard]] std::optional<std::size_t> lamp_that_tells(const LightChange& change, std::span<const ChangeCause> causes,
                                                         std::span<const std::uint8_t> may, double level_share,
                                                         const Eigen::VectorXd& dip_error_lx);

inline constexpr std::size_t kMostCauses = 3;
/// How well it is known what a lamp gives at a meter, as a share of that.
inline constexpr double kLampShare = 0.15;
/// How well the exponent of a dimmer's curve is known that nobody measured, as a share.
inline constexpr double kCurve = 0.05;

}  // namespace luxrig
