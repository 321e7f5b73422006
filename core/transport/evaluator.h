#pragma once
/// From emitters to lux. One interface, several evaluators; solvers never know which one they use.
///
/// Illuminance is linear in emittance: E = T c (thesis eq. 5.1). An evaluator returns T for the given
/// receivers and emitters, sampled until the illuminance of each receiver, under the given levels, has
/// the wanted relative error.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/photometry/shapes/luminous_shape.h"
#include "core/photometry/sky/sky_luminance.h"
#include "core/result.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

/// A point that receives light on the side of its normal.
struct Receiver {
  Vec3 position_world_m;
  Vec3 normal_world;  ///< unit
};

/// A luminaire as hung and aimed, or a sky.
struct Emitter {
  Intensity intensity;
  Pose world_from_lamp;
  LuminousShape shape{};
  /// Colour of its light in linear Rec. 709, with a luminance of 1: 0.2126 r + 0.7152 g + 0.0722 b = 1.
  Vec3 colour_rgb = Vec3::Ones();
  Sky sky{};  ///< if set, this is a sky: intensity, pose and shape are ignored
};

struct EvaluateOptions : Run {
  /// wanted_relative_error in standard errors of each receiver. 1 would keep it on average; 2.5 keeps the actual error
  /// below it for 98 of 100 receivers. It also covers an estimate from 16 replicates that is too low by 1.44 (χ², 15
  /// degrees of freedom, 5 %), which is common since sampling stops at the first low estimate.
  static constexpr double kStopMargin = 2.5;

  /// Wanted error of each receiver's illuminance, relative to max(its illuminance, the floor below). Exact evaluators
  /// ignore it.
  double wanted_relative_error = 0.01;
  /// The floor: the larger of a value in lux and a share of the receivers' mean, but at least 0.001 of the brightest
  /// receiver's illuminance.
  double floor_lx = 0, floor_of_mean = 0;
  /// If above 0: wanted root mean square of the receivers' standard errors, instead of each receiver's error. Samples
  /// then go where they lower it most; receivers that converge slowly keep larger errors.
  double wanted_rms_error = 0;
  std::uint64_t max_rays = 2'000'000'000;  ///< stops there and reports the error reached
  std::vector<double> levels;              ///< per emitter, ≥ 0; empty = all 1
  bool colour = false;                     ///< also fill TransportMatrix::rgb_per_level
  std::stop_token enough;  ///< on request, returns soon with the result so far and its error

  /// Standard error at which a receiver is done; with wanted_rms_error, of all receivers together.
  [[nodiscard]] double wanted_standard_error() const {
    return wanted_rms_error > 0 ? wanted_rms_error : wanted_relative_error / kStopMargin;
  }
};

/// T with statistics. Rows are receivers, columns emitters.
struct TransportMatrix {
  Eigen::MatrixXd lux_per_level;  ///< total (direct and indirect)
  Eigen::MatrixXd direct_lux_per_level;
  /// Independent unbiased estimates with mean lux_per_level; empty when exact. They carry the correlations between
  /// columns, so that the error of T c is right for every c.
  std::vector<Eigen::MatrixXd> replicates;
  /// With EvaluateOptions::colour, lux_per_level by linear Rec. 709 primary; weighted with 0.2126, 0.7152 and 0.0722
  /// the three sum to it. Otherwise empty.
  std::vector<Eigen::MatrixXd> rgb_per_level;
  double relative_error = 0;  ///< standard error reached, at the options' levels; largest over receivers
  double rms_error = 0;       ///< the same, root mean square over receivers
  double floor_lx = 0;        ///< relative_error of a dimmer receiver is relative to this; 0 when exact
  std::uint64_t rays = 0;

  [[nodiscard]] Eigen::Index receivers() const { return lux_per_level.rows(); }
  [[nodiscard]] Eigen::Index emitters() const { return lux_per_level.cols(); }
  [[nodiscard]] Eigen::VectorXd lux(const Eigen::VectorXd& levels) const { return lux_per_level * levels; }
  [[nodiscard]] Eigen::VectorXd direct_lux(const Eigen::VectorXd& levels) const {
    return direct_lux_per_level * levels;
  }
  /// Standard error [lx] of lux(levels); zeros when exact.
  [[nodiscard]] Eigen::VectorXd standard_error_lux(const Eigen::VectorXd& levels) const;
};

/// Joins columns of two matrices with the same receivers. Errors are computed for the result, at the options' levels.
/// kept   per column: index of a column of `before`; none = the next column of `anew`, in order
/// Requires both with colours or both without; rays are those of `anew`.
[[nodiscard]] TransportMatrix joined_columns(const TransportMatrix& before, const TransportMatrix& anew,
                                             std::span<const std::optional<std::size_t>> kept,
                                             const EvaluateOptions& options);

/// Weighted mean of two independent estimates: `share` of `a`, the rest of `b`. Errors as above; rays are those of
/// both.
[[nodiscard]] TransportMatrix mean_of(const TransportMatrix& a, double share, const TransportMatrix& b,
                                      const EvaluateOptions& options);

class Evaluator {
 public:
  virtual ~Evaluator() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Cause::cancelled when stopped; Cause::invalid when an emitter is in a receiver (its lux is infinite) or an input
  /// is not finite.
  [[nodiscard]] virtual Result<TransportMatrix> evaluate(std::span<const Receiver> receivers,
                                                         std::span<const Emitter> emitters,
                                                         const EvaluateOptions& options) const = 0;
};

/// Direct light only, one shadow ray per pair that could see each other; exact for point luminaires.
[[nodiscard]] std::unique_ptr<Evaluator> make_direct_evaluator(const RayScene& scene);

/// Direct light and interreflection, diffuse and glossy: paths from the receivers joined with light traced from the
/// emitters, Owen-scrambled Sobol samples, Russian roulette. Unbiased; standard error from replicates. The reference.
[[nodiscard]] std::unique_ptr<Evaluator> make_path_evaluator(const RayScene& scene);

/// The same, but the light beyond a path's second vertex is shared among all receivers, through records on the surfaces
/// that they see. Several times cheaper for tens of receivers or more; biased by a fraction of a per cent.
[[nodiscard]] std::unique_ptr<Evaluator> make_gather_evaluator(const RayScene& scene);

}  // namespace luxrig
