#include "core/transport/direct/direct_light.h"

namespace luxrig {
namespace {

class DirectEvaluator final : public Evaluator {
 public:
  explicit DirectEvaluator(const RayScene& scene) : scene_(scene) {}
  std::string_view name() const override { return "direct"; }

  Result<TransportMatrix> evaluate(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                   const EvaluateOptions& options) const override {
    if (auto checked = check_evaluation(receivers, emitters, options); !checked)
      return tl::unexpected(std::move(checked.error()));
    auto direct = direct_light(scene_, receivers, emitters, options);
    if (!direct) return tl::unexpected(std::move(direct.error()));
    TransportMatrix matrix;
    matrix.direct_lux_per_level = std::move(direct->lux_per_level);
    matrix.lux_per_level = matrix.direct_lux_per_level;
    matrix.replicates = std::move(direct->replicates);
    matrix.relative_error = direct->relative_error;
    matrix.rms_error = direct->rms_error;
    matrix.floor_lx = direct->floor_lx;
    matrix.rays = direct->rays;
    if (options.colour)
      for (int primary = 0; primary < 3; ++primary) {
        Eigen::MatrixXd& of = matrix.rgb_per_level.emplace_back(matrix.lux_per_level);
        for (std::size_t e = 0; e < emitters.size(); ++e)
          of.col(static_cast<Eigen::Index>(e)) *= emitters[e].colour_rgb[primary];
      }
    return matrix;
  }

 private:
  const RayScene& scene_;
};

}  // namespace

std::unique_ptr<Evaluator> make_direct_evaluator(const RayScene& scene) {
  return std::make_unique<DirectEvaluator>(scene);
}

}  // namespace luxrig
