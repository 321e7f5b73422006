#pragma once
/// References for the rows of one moved luminaire, receiver or object.

#include "tools/bench/transport/case.h"

namespace luxrig {

struct MovedTruth {
  Emitter lamp;                ///< at its new place
  Eigen::VectorXd lux;         ///< of it alone, converged
  Eigen::VectorXd direct_lux;  ///< its direct part, exact
  Eigen::VectorXd total_lux;   ///< of all lamps, with this one at its new place
  double reference_error = 0;  ///< standard error of lux, rms, relative as RoomError
};

/// The converged column of a lamp at another place. All lamps are sampled, the others at a fiftieth. Otherwise rooms
/// with a millionth of the lamp's light, which no figure here uses, would have to be known to a per cent. `one` is
/// unchanged on return.
[[nodiscard]] Reference column_reference(TransportCase& one, std::size_t number, const Emitter& lamp,
                                         const BenchOptions& options);

/// rms of the moved lamp's error, relative to the receivers' total light.
[[nodiscard]] double error_of_moved(const Eigen::VectorXd& lux, const Eigen::VectorXd& exact_lx,
                                    const Eigen::VectorXd& total_lx);

/// Rows of IncrementalTransport for a moved lamp, a moved receiver and a moved object.
void add_incremental_rows(const TransportCase& one, const MovedTruth& truth, const BenchOptions& options,
                          std::vector<BenchRow>& rows);

inline constexpr double kMovedDirectSeconds = 0.005, kMovedSeconds = 0.1, kMovedError = 0.02;

}  // namespace luxrig
