#pragma once
/// Dimmer curves of several lamps at once. What each lamp gives at each luxmeter was read with all else dark; light adds,
/// so what the meters show under several dimmed lamps says how far each is dimmed:
///
///   reading(meter) = Σ_lamps share(lamp) · alone(meter, lamp)
///
/// Weighted least squares. Which lamps go together is chosen so that none is read much worse than alone.

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/lamp_steps.h"

namespace luxrig {

/// Luxmeters × lamps, the dark taken off; NaN = not read.
struct LightAlone {
  Eigen::MatrixXd lux, standard_error_lx;
};

/// Groups of lamps whose dimmers are read at once. Each lamp that any meter sees is in one. may: whether these lamps may be
/// lit together, half dimmed; one alone always may.
[[nodiscard]] std::vector<std::vector<std::size_t>> curve_groups(
    const LightAlone& alone, const std::function<bool(std::span<const std::size_t>)>& may);

struct ShareOfAlone {
  double value = 0;
  double standard_error = 0;  ///< but for that of its own light alone, which all its shares have in common
};

/// Of each of these lamps, its light under this reading over that alone. above_dark: per luxmeter; none = not read. Empty
/// if the readings do not tell.
[[nodiscard]] std::vector<ShareOfAlone> shares_of(const LightAlone& alone, std::span<const std::size_t> lamps,
                                                  std::span<const std::optional<SteadyReading>> above_dark);

}  // namespace luxrig
