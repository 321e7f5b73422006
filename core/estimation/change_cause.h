#pragma once
/// Why luxmeters read something else than before at the same levels: which single cause explains all of them, and
/// whether any other would, too.
///
/// Each cause predicts how the reading of every meter changes. A lamp that loses light takes from each meter what it gave
/// there; a covered meter changes alone; a head that was knocked takes from some meters and gives to others. A cause is
/// found only if the changes are far beyond noise, it explains them, and no other cause explains them nearly as well.
/// Causes are compared by their evidence: χ², and what each thing that could have been anything costs.
///
/// Source: D. J. C. MacKay, Bayesian Interpolation, Neural Computation 4 (1992): evidence and Occam factors.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace luxrig {

/// At one set of levels. Vectors: an entry per luxmeter; NaN in now_lx = not read.
struct LightChange {
  Eigen::VectorXd before_lx, now_lx;
  Eigen::VectorXd error_lx;    ///< standard error of the difference by noise, > 0
  Eigen::MatrixXd of_fixture;  ///< luxmeters × fixtures: light of each in before_lx [lx]
  Eigen::VectorXd daylight;    ///< in before_lx; empty = none
  Eigen::VectorXd level;       ///< per fixture
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
  double share = 1;   ///< light of the lamp, of all or of the day over that before; reading over before of a meter
  double margin = 0;  ///< by how much it is better than the next cause: 12 is a likelihood ratio of 400
};

/// The causes that explain the change, best first: one if it is clear. Several if they explain it about as well (at most
/// kMostCauses). Kind::unclear alone if none explains it, or too many do.
[[nodiscard]] std::vector<ChangeCause> causes_of(const LightChange& change);

inline constexpr std::size_t kMostCauses = 3;
/// How well it is known what a lamp gives at a meter, as a share of that.
inline constexpr double kLampShare = 0.15;

}  // namespace luxrig
