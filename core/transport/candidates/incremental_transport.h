#pragma once
/// Light of single luminaires at fixed receivers, evaluated repeatedly: moving, aiming or trying a lamp takes
/// milliseconds, since everything that depends on scene and receivers is kept.
///
/// Same mathematics and limits as stream_candidates(). Cost of a change:
///   a luminaire          its column: a shadow ray per receiver, and rays that look up the importance of surfaces
///   a receiver           one row of the importance: visibility of the cells from there, and their interreflection
///   an object            direct light where a line of sight meets it; reflected light everywhere: call make() again

#include <memory>

#include "core/run.h"
#include "core/transport/candidates/candidate_transport.h"

namespace luxrig {

struct IncrementalOptions : Run {
  bool indirect = true;
  /// Surface cells per estimate, and rays per cell: see surface_importance.h. Finer settings slow down make(), not
  /// column().
  std::size_t cells = 10'000;
  std::uint32_t rays_per_cell = 48;
  std::uint32_t rays_per_column = 16'384;  ///< for one luminaire, in total
};

/// Lux at all receivers, per unit emittance.
struct LuminaireColumn {
  Eigen::VectorXd direct_lux;
  Eigen::VectorXd total_lux;
  Eigen::VectorXd standard_error_lux;  ///< of total_lux
  std::uint64_t rays = 0;
};

class IncrementalTransport {
 public:
  /// Solves the importance of surfaces. scene and rays must outlive it.
  /// Cause::invalid for inputs that check_evaluation() refuses; Cause::cancelled when stopped.
  [[nodiscard]] static Result<std::unique_ptr<IncrementalTransport>> make(const Scene& scene, const RayScene& rays,
                                                                          std::span<const Receiver> receivers,
                                                                          const IncrementalOptions& options);
  virtual ~IncrementalTransport() = default;

  /// Cause::invalid for an emitter that check_evaluation() refuses, a shape or a sky. Thread-safe. The same emitter
  /// always gives the same bytes.
  [[nodiscard]] virtual Result<LuminaireColumn> column(const Emitter& emitter) const = 0;
  /// The exact direct part alone: direct_lux, with total_lux equal to it.
  [[nodiscard]] virtual Result<LuminaireColumn> direct_column(const Emitter& emitter) const = 0;

  /// Moves or turns one receiver. Cells that only it sees are not added: move receivers only within the air of the
  /// others.
  [[nodiscard]] virtual Result<void> move_receiver(std::size_t receiver, const Receiver& to) = 0;

  /// Direct columns of many luminaires after a change of the scene within a box (of the moved objects' surfaces, before
  /// and after). Entries whose line of sight misses the box are kept; the others are traced in `rays`. Returns the
  /// shadow rays cast. lux: receivers × emitters. Cause::invalid, with nothing changed, for an emitter that column()
  /// refuses, a matrix of another size, or a box that is not finite. Reflected light does not follow a moved object:
  /// column() still answers for the scene of make().
  [[nodiscard]] virtual Result<std::uint64_t> update_direct(std::span<const Emitter> emitters, const RayScene& rays,
                                                            const Eigen::AlignedBox3d& changed_world_m,
                                                            Eigen::MatrixXd& lux) const = 0;

  /// Rays cast by the last make() or move_receiver().
  [[nodiscard]] virtual std::uint64_t rays() const = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

}  // namespace luxrig
